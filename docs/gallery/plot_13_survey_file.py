"""
A survey in one file
====================

For somebody who has to show later how a map came about.

A survey file is a GeoPackage: every event of the survey is in it, and a GIS opens it. It can be
read while the survey runs, gone on with after a crash, and verified: every fit and plan is
decided again from the events before it.
"""

# %%
# The file is there from the first moment. A simulated robot then works on the survey, and every
# report is on disk before the next push.

import tempfile
from pathlib import Path

import subsoil as ss
from subsoil.journal import create, fingerprint, open_journal, read_survey, verify
from subsoil.survey import LocalDispatch, Settings, fold, opening
from subsoil.survey.events import Configured
from subsoil.survey.simulated import SIMULATED, simulation_of, soil_drawn, work

field = ss.Field.from_metres([(0, 0), (120, 0), (120, 80), (0, 80)], name="Mill Field")
layers = ss.Layers((0.0, 0.1, 0.2, 0.3, 0.4))
path = Path(tempfile.mkdtemp()) / "survey.gpkg"
with create(path, opening(field, layers, ss.SMALL_CONE)):
    pass

truth = soil_drawn(field, layers, seed=3)
with open_journal(path) as journal:
    dispatch = LocalDispatch(fold(journal.events()), journal)
    dispatch.record(Configured(settings=Settings(start=field.entrance, samples=16, seed=3)))
    dispatch.join(SIMULATED, "simulator", simulation=simulation_of(truth, "simulated", 3))
    work(dispatch, truth)

# %%
# Anybody who has the file can check it. Two people with the same fingerprint hold the same
# survey.

verdict = verify(path)
content = read_survey(path)
print(f"{len(content.events)} events, {len(verdict.findings)} findings")
print(f"fingerprint {fingerprint(content.last[1])}")

# %%
# Opened again it is the survey that it was, with its map and its way.

survey = fold(content.events)
figure = ss.plots.depth_slices(survey, caption=f"read from {path.name}; simulated")
figure
