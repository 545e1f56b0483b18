"""The predictor that runs the controller is the kinetic one wherever no controller acts."""

import importlib.util

import pytest
from ships import equipped

from shipcosim.series import read_table

ENDS = [f"{axis}_{end}" for axis in ("x", "y", "psi") for end in (10, 30, 60)]
LOST = dict.fromkeys(("tau_X_allocated", "tau_Y_allocated", "tau_N_allocated"), 0.0)
NAMES = {"predictor": "Predictor", "dp_predictor": "DpPredictor"}


@pytest.fixture(scope="module")
def predicted(root):
    """Function from the name of an FMU and inputs held to its outputs, after half a minute of its reference result."""
    given = read_table(root / "fmus" / "dp_predictor" / "reference.csv")

    def predict(name, **held):
        spec = importlib.util.spec_from_file_location(
            f"predicting_{name}", root / "fmus" / name / f"{name}.py"
        )
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        fmu = equipped(getattr(module, NAMES[name])(), "predictor")
        inputs = [one.name for one in fmu.variables if one.causality == "input"]
        fmu.start_time = 0.0
        for row in range(61):
            values = {one: given[one].values[row] for one in inputs} | held
            for one, value in values.items():
                setattr(fmu, one, bool(value) if one == "wind_rejected" else float(value))
            fmu.step(0.5 * row, 0.5) if row else fmu.start()
        return [getattr(fmu, end) for end in ENDS]

    return predict


@pytest.mark.parametrize("held", [LOST, {"x_goal": 1e9}], ids=["thrust lost", "no goal wired"])
def test_it_is_the_kinetic_predictor(predicted, held):
    assert predicted("dp_predictor", **held) == predicted("predictor", **held)


def test_with_thrust_it_goes_to_the_goal(predicted):
    """20 m north, told half a minute ago: in a minute 17 m are done, whatever the thrust of now would do."""
    ahead, kinetic = predicted("dp_predictor"), predicted("predictor")
    assert ahead[2] == pytest.approx(17.0, abs=1.0) and abs(kinetic[2] - 17.0) > 2.0
