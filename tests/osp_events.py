"""Events in OSP's words, and scenario files of them, that several tests use."""

import json

import yaml

EVENTS = [
    {"time": 0.1, "model": "law", "variable": "u", "action": "override", "value": 2.5},
    {"time": 0.2, "model": "law", "variable": "u", "action": "bias", "value": -0.25},
    {"time": 0.3, "variable": "u", "action": "reset"},
    {"time": 0.43, "model": "plant", "variable": "y", "value": 1.5},
    {"time": 0.5, "model": "plant", "variable": "y", "action": "bias", "value": 1e-1},
]
DEFAULTS = {"model": "law", "action": "override"}


def written(path, **content):
    text = json.dumps(content) if path.suffix == ".json" else yaml.safe_dump(content)
    path.write_text(text, encoding="utf-8")
    return path
