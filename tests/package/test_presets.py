"""Presets in files that a user wrote."""

import json

import numpy as np
import pytest

from dielectric_actuator import presets

GOOD = {"title": "a", "description": "b", "start_values": {"phi": 0.3}, "stop_time": 1.0, "communication_step": 0.1}


@pytest.mark.parametrize("place, value, message", [
    ("start_values", [0.3], "it must be numbers by the names of variables"),
    ("start_values", {"phi": "0.3"}, "it must be numbers by the names of variables"),
    ("stop_time", "soon", "stop_time of .* is 'soon'; it must be a number"),
    ("title", None, "title of .* is None; it must be a text"),
    ("model", ["si"], "it must be a text"),
])  # fmt: skip
def test_a_preset_with_a_value_of_the_wrong_kind_is_refused(tmp_path, place, value, message):
    path = tmp_path / "mine.json"
    path.write_text(json.dumps(GOOD))
    assert presets.load(path) == presets.Preset(**GOOD)
    path.write_text(json.dumps({**GOOD, place: value}))
    with pytest.raises(ValueError, match=message):
        presets.load(path)


def test_numbers_of_numpy_are_written(tmp_path):
    values = {"phi": np.float32(0.5), "on_pull_in": np.int64(1)}
    path = presets.Preset("a", "b", values, 1.0, 0.1).save(tmp_path / "mine.json")
    assert presets.load(path).start_values == {"phi": 0.5, "on_pull_in": 1.0}
