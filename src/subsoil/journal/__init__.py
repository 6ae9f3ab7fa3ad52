"""The survey file: one GeoPackage that holds every event, and shows the survey to any GIS."""

from subsoil.journal.content import Content, fingerprint
from subsoil.journal.file import Journal, create, open_journal
from subsoil.journal.look import copy, is_survey, last_event, read_events, read_survey
from subsoil.journal.verify import verify

__all__ = [
    "Content",
    "Journal",
    "copy",
    "create",
    "fingerprint",
    "is_survey",
    "last_event",
    "open_journal",
    "read_events",
    "read_survey",
    "verify",
]
