"""What can be changed about the view is what the view holds."""

from typing import get_type_hints

from pinwarp.session.view import ViewChanges, ViewState


def test_every_field_of_the_view_can_be_changed_and_with_its_own_type():
    assert get_type_hints(ViewChanges) == get_type_hints(ViewState)
