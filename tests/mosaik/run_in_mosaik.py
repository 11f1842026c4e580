"""The scene of tests/hosts over mosaik-fmi: ``run_in_mosaik.py PACKAGES FOLDER KIND`` prints λ and λ3 after each step.

PACKAGES is where mosaik-fmi and fmipp are, FOLDER holds the packed FMU, KIND is cs or me.
"""

import sys
from pathlib import Path

sys.path.insert(0, sys.argv[1])
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "hosts"))

from mosaik_components.fmi.mosaik_fmi import FmuAdapter

from run_in_host import MODEL, OUTPUTS, PHI_THEN, START_VALUES, STEP, STEPS, SWITCH

INPUTS = ("phi", "S")


def main(folder: str, kind: str) -> None:
    """Run the scene, print."""
    adapter = FmuAdapter()
    # mosaik's time is whole numbers; a unit of it is one step here.
    settings = {"step_size": 1, "step_factor": STEP}
    adapter.init("simulator", folder, MODEL, kind, instance_name="actuator", logging_on=False, **settings)
    parameters = {name: value for name, value in START_VALUES.items() if name not in INPUTS}
    [entity] = adapter.create(1, "actuator", **parameters)
    identifier = entity["eid"]
    for step in range(STEPS):
        inputs = {"phi": START_VALUES["phi"] if step < SWITCH else PHI_THEN, "S": START_VALUES["S"]}
        reached = adapter.step(step, {identifier: {name: {"source": value} for name, value in inputs.items()}})
        # With model exchange the adapter answers in the FMU's time.
        assert reached == (step + 1) * (STEP if kind == "me" else 1)
        row = adapter.get_data({identifier: list(OUTPUTS)})[identifier]
        print("row", *(row[name] for name in OUTPUTS))


if __name__ == "__main__":
    main(*sys.argv[2:])
