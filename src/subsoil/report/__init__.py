"""The report of a survey: its pictures, and one page that says what they are worth."""

from subsoil.report.page import Picture, render, write_report
from subsoil.survey.progress import Progress

__all__ = ["Picture", "Progress", "render", "write_report"]
