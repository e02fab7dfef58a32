"""Every way to change a session: Session -> Session, one function per verb, nothing else.

A verb stands in the module of its subject, and in that module's ``__all__``.
"""

from pinwarp.session.edits.arriving import *
from pinwarp.session.edits.bones import *
from pinwarp.session.edits.groups import *
from pinwarp.session.edits.landmarks import *
from pinwarp.session.edits.placing import *
from pinwarp.session.edits.settings import *
