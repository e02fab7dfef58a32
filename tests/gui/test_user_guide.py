"""The user guide says what is there, and is read, searched and left by mouse and keys."""

from __future__ import annotations

import re

import pytest
import typer.main
from qtpy.QtCore import QPoint, Qt
from qtpy.QtGui import QTextCursor
from qtpy.QtTest import QTest

from pinwarp.cli.app import make_app
from pinwarp.gui.pages.library import Page, pages_about, read_pages
from pinwarp.io.samples import help_folder

PAGES = read_pages(help_folder())
COMMANDS = typer.main.get_command(make_app(lambda *_: 0))
NAMES = COMMANDS.list_commands(None)


@pytest.fixture(params=PAGES, ids=lambda page: page.name)
def page(request) -> Page:
    return request.param


@pytest.fixture
def guide(user):
    """The guide, opened by its key."""
    QTest.keyClick(user.window, Qt.Key.Key_F1)
    user.settle()
    user.wait_until_in_front(user.window.parts.user_guide.window)
    return user.window.parts.user_guide.window


def options_of(name: str) -> set[str]:
    """Return the options of a command; those of ``open`` where none is named."""
    command = COMMANDS.get_command(None, name or "open")
    return {one for parameter in command.params for one in (*parameter.opts, "--help")}


def click_title(guide, title: str) -> None:
    (item,) = guide.titles.findItems(title, Qt.MatchFlag.MatchExactly)
    at = guide.titles.visualItemRect(item).center()
    QTest.mouseClick(guide.titles.viewport(), Qt.MouseButton.LeftButton, pos=at)


def titles(guide) -> list[str]:
    return [guide.titles.item(row).text() for row in range(guide.titles.count())]


# What the pages say


def test_pages_name_only_actions_that_there_are(user):
    actions = user.window.actions_by_key
    for page in PAGES:
        for key, what in page.fields:
            assert key in actions, f"{page.name}: {key}"
            if what == "keys":
                words = user.window.parts.user_guide._words(key, what)
                assert words != "****", f"{page.name}: {key} has no shortcut"


def test_a_page_that_named_an_action_that_is_gone_would_fail(user):
    with pytest.raises(KeyError):
        Page("a.md", "Press {no_such_action}.").filled(user.window.parts.user_guide._words)


def test_no_page_has_a_field_that_nobody_fills(user):
    for page in user.window.parts.user_guide.pages():
        assert not re.search(r"[{}]", page.text), page.name


def test_pages_name_only_gestures_that_the_sheet_lists(user):
    lines = [line for _, lines in user.window.shortcuts.lines() for line in lines]
    known = " ".join(f"{keys} {words}" for keys, words in lines)
    for page in PAGES:
        for gesture in re.findall(r"\*\*((?:Ctrl|Shift|Alt)\+[^*]+)\*\*", page.text):
            assert gesture in known, f"{page.name}: {gesture}"


def test_pages_name_only_commands_and_options_that_there_are(page):
    spans = re.findall(r"`(pinwarp[^`\n]*)`|^    (pinwarp .*)$", page.text, re.M)
    for line in (first or second for first, second in spans):
        words = line.split()
        named = words[1] if len(words) > 1 and not words[1].startswith("-") else ""
        assert not named or named in NAMES, line
        for option in (word for word in words[1:] if word.startswith("--")):
            assert option in options_of(named), line


def test_every_command_has_its_line():
    (page,) = (page for page in PAGES if "commands" in page.name)
    for name in set(NAMES) - {"open"}:
        assert f"| `pinwarp {name}` |" in page.text


def test_links_lead_to_pages_and_pictures_that_there_are(page):
    targets = re.findall(r"\]\(([^)]+)\)", page.text)
    for target in targets:
        assert (help_folder() / target).is_file(), target


def test_no_picture_is_shipped_that_no_page_shows():
    shown = {name for page in PAGES for name in re.findall(r"\(pictures/([^)]+)\)", page.text)}
    assert {path.name for path in (help_folder() / "pictures").iterdir()} == shown


# Reading


def test_the_guide_opens_at_its_first_page_and_shows_its_picture(guide):
    assert guide.isVisible()
    assert guide.page == PAGES[0].name
    assert "File > Open Source Mesh… (Ctrl+1)" in guide.text.toPlainText()
    picture = guide.text.document().resource(2, guide.text.source().resolved("pictures/window.png"))
    assert picture is not None
    assert guide.text.document().size().height() > 700, "with the picture in it"


def test_a_click_on_a_title_shows_that_page(guide):
    click_title(guide, "Maps")
    assert guide.page == "05-maps.md"
    assert guide.text.toPlainText().startswith("Maps")


def test_a_link_leads_to_another_page(guide):
    place = guide.text.document().find("Landmarks and ghosts")
    guide.text.setTextCursor(place)
    cursor = QTextCursor(place)
    cursor.setPosition(place.selectionStart() + 3)
    at = guide.text.cursorRect(cursor).center()
    QTest.mouseMove(guide.text.viewport(), at)
    QTest.mouseClick(guide.text.viewport(), Qt.MouseButton.LeftButton, pos=QPoint(at))
    assert guide.page == "02-landmarks.md"


def test_a_search_leaves_the_pages_with_all_its_words_and_marks_them(guide):
    QTest.keyClicks(guide.search, "poles overshoots")
    assert titles(guide) == ["The warping penalty and its sign"]
    assert guide.page == "03-penalty.md"
    marked = {x.cursor.selectedText() for x in guide.text.extraSelections()}
    assert marked == {"poles", "overshoots"}
    QTest.keyClick(guide.search, Qt.Key.Key_Return)
    assert guide.text.textCursor().selectedText() == "poles"
    QTest.keyClick(guide.search, Qt.Key.Key_Escape)
    assert guide.search.text() == ""
    assert len(titles(guide)) == len(PAGES)
    assert guide.text.extraSelections() == []


def test_a_search_without_a_find_says_so(guide):
    QTest.keyClicks(guide.search, "zebra")
    assert titles(guide) == []
    assert guide.nothing.isVisible()
    guide.search.clear()
    assert not guide.nothing.isVisible()


def test_a_page_with_the_word_in_its_title_comes_first():
    assert pages_about(PAGES, "maps")[0].title == "Maps"


def test_the_help_menu_opens_the_page_that_explains_the_figures(user):
    user.trigger("about_quality")
    guide = user.window.parts.user_guide.window
    assert guide.page == "04-trust.md"
    for word in ("residual", "leave-one-out", "displaced", "isolated"):
        assert word in guide.text.toPlainText()
    user.trigger("about_penalty")
    assert guide.page == "03-penalty.md"


def test_escape_closes_the_guide_and_the_key_opens_it_where_it_was(user, guide):
    click_title(guide, "Cohorts")
    QTest.keyClick(guide, Qt.Key.Key_Escape)
    assert not guide.isVisible()
    user.trigger("user_guide")
    assert guide.isVisible()
    assert guide.page == "08-cohorts.md"
