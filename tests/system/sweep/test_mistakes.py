"""Mistakes in study files: each key's is said with file and line, what was found, and what would be right."""

import re
import types
import typing

import pytest
from pydantic import BaseModel

from shipcosim.errors import ShipcosimError
from shipcosim.scenario import Event, Expectation
from shipcosim.sweep import plan_of, read_study
from shipcosim.sweep.study_model import Study

WHOLE = """
description     = "a study with every key"
scenario        = "filling"
seed            = 3
stop_time       = "2 s"
step_size       = "0.1 s"
output_interval = "0.2 s"
fork_at         = "1 s"
parameters      = ["lags.ssv"]

[components]
other = "lag"

[set]
"lag.noise" = "1 cm"

[names]
both = ["lag", "other"]

[[events]]
time     = "0.5 s"
override = { "other.u" = 2.0 }

[[factor]]
name   = "level"
signal = "both.u"
values = ["100 cm", 2.0]

[[factor]]
name   = "constant"
signal = ["lag.time_constant"]
from   = "1 s"
to     = "2 s"
count  = 2

[[factor]]
name     = "later"
signal   = "lag.u"
values   = [1.0, 2.0]
at_fork  = true

[[factor]]
name   = "limit"
signal = "other.ends_above"
from   = 0.0
to     = 0.2
step   = 0.1

[[factor]]
name = "case"

[[factor.case]]
label      = "as she is"

[[factor.case]]
label      = "otherwise"
set        = { "other.u" = 1.5 }
events     = [{ time = 1.0, bias = { "other.u" = 0.1 } }]
parameters = ["lags.ssv"]
components = { other = "lag" }
stop_time  = "1 s"

[[factor]]
name  = "seed"
seeds = 2

[sample]
method = "sobol"
runs   = 2

[sample.of."other.time_constant"]
distribution = "uniform"
loc          = 100.0
scale        = 50.0
unit         = "ms"
name         = "sampled"
at_fork      = false

[sample.of."other.noise"]
distribution = "norm"
tolerance    = false
also         = ["lag.noise"]

[[quantity]]
name        = "highest"
description = "the largest level"
signal      = "lag.y"
reduce      = "maximum"
during      = ["0 s", "1 s"]

[[quantity]]
name   = "farthest"
signal = ["lag.y", "other.y"]
near   = [0.0, "10 cm"]
reduce = "time_beyond"
limit  = "1 m"

[[quantity]]
name   = "then"
signal = "lag.y"
reduce = "at"
time   = "1 s"

[[quantity]]
name       = "usual"
signal     = "lag.y"
reduce     = "percentile"
percentile = 90.0

[[quantity]]
name   = "held"
expect = [{ signal = "lag.y", at_most = 2.5 }]

[[quantity]]
name                  = "expected"
scenario_expectations = true

[[summary]]
name        = "p90"
description = "over the seeds"
quantity    = "highest"
over        = "seed"
statistic   = "percentile"
percentile  = 90.0

[[summary]]
name      = "last"
quantity  = "held"
over      = ["seed"]
statistic = "last_held"
along     = "case"
share     = 0.9
none      = "none"

[[view]]
kind  = "scatter"
title = "levels"
x     = "level"
y     = "highest"

[tracks]
signals  = ["lag.y"]
interval = "0.2 s"
"""
TEXTS = ("note", "table", "angle", "radius", "quantity", "category", "marked")
MISTAKES = [
    # key, line of WHOLE, what stands in its place, what is found, what would be right
    ("extends", "", 'extends = "levls"', "no study 'levls'", "levels"),
    (
        "description",
        'description     = "a study with every key"',
        "description = 3",
        "description = 3",
        "text",
    ),
    (
        "scenario",
        'scenario        = "filling"',
        'scenario = "fillin"',
        "no scenario 'fillin'",
        "filling",
    ),
    ("seed", "seed            = 3", "seed = -1", "seed = -1", "greater than or equal to 0"),
    ("stop_time", 'stop_time       = "2 s"', 'stop_time = "2 m"', "'2 m' is in m", "in s"),
    (
        "stop_time",
        'stop_time       = "2 s"',
        'stop_time = "2.05 s"',
        "no multiple of the step size",
        "2",
    ),
    (
        "step_size",
        'step_size       = "0.1 s"',
        "step_size = 0.0",
        "step_size = 0.0",
        "greater than 0",
    ),
    (
        "output_interval",
        'output_interval = "0.2 s"',
        'output_interval = "0.25 s"',
        "no multiple",
        "0.2 s",
    ),
    (
        "fork_at",
        'fork_at         = "1 s"',
        'fork_at = "5 s"',
        "fork_at = 5 s",
        "before the end at 2 s",
    ),
    (
        "parameters",
        'parameters      = ["lags.ssv"]',
        'parameters = ["lag"]',
        "no parameter set 'lag'",
        "lags",
    ),
    ("components", 'other = "lag"', 'othr = "lag"', "no component 'othr'", "other"),
    ("components", 'other = "lag"', 'other = "lagg"', "no FMU 'lagg'", "lag"),
    ("set", '"lag.noise" = "1 cm"', '"lag.nois" = "1 cm"', "nois", "noise"),
    ("set", '"lag.noise" = "1 cm"', '"lag.noise" = "1 s"', "'1 s'", "m"),
    ("names", 'both = ["lag", "other"]', 'both = ["lag", "othr"]', "othr", "other"),
    ("names", 'both = ["lag", "other"]', 'both = "lag"', 'both = "lag"', "list"),
    (
        "events.time",
        'time     = "0.5 s"',
        'time = "0.55 s"',
        "0.55 s is no multiple of the step size",
        "0.1 s",
    ),
    (
        "events.override",
        'override = { "other.u" = 2.0 }',
        'override = { "other.v" = 2.0 }',
        "'v'",
        "u, y",
    ),
    (
        "events",
        'override = { "other.u" = 2.0 }',
        'overide = { "other.u" = 2.0 }',
        "'overide'",
        "override",
    ),
    (
        "factor",
        'values = ["100 cm", 2.0]',
        'value = ["100 cm", 2.0]',
        "unknown key 'value'",
        "values",
    ),
    ("factor.name", 'name   = "level"', 'name = "run"', "'run' is a column", "another name"),
    ("factor.signal", 'signal = "both.u"', 'signal = "both.w"', "has no variable 'w'", "u, y"),
    ("factor.values", 'values = ["100 cm", 2.0]', 'values = ["100 deg", 2.0]', "100 deg", "m"),
    ("factor.from", 'from   = "1 s"', 'from = "1 m"', "1 m", "s"),
    ("factor.from", 'from   = "1 s"', 'from = "0 s"', "0", "0.01"),
    ("factor.to", 'to     = "2 s"', 'to = "two"', 'to = "two"', "number"),
    ("factor.count", "count  = 2", "count = 1", "count = 1", "greater than or equal to 2"),
    (
        "factor.step",
        "step   = 0.1",
        "step = -0.1",
        "Steps of -0.1 do not lead from 0.0 to 0.2",
        "another step",
    ),
    ("factor.at_fork", "at_fork  = true", 'at_fork = "yes"', 'at_fork = "yes"', "true or false"),
    (
        "factor.case",
        'name = "case"',
        'name = "case"\nsignal = "lag.u"',
        "Cases say themselves",
        "not used",
    ),
    (
        "factor.directions",
        "seeds = 2",
        "directions = 1",
        "directions = 1",
        "greater than or equal to 2",
    ),
    (
        "factor.directions",
        "seeds = 2",
        "directions = 4",
        "component or connector 'environment'",
        "lag",
    ),
    ("factor.conditions", "seeds = 2", "conditions = [12]", "= 12", "1, 2"),
    ("factor.seeds", "seeds = 2", "seeds = 0", "seeds = 0", "greater than or equal to 1"),
    (
        "factor.case.label",
        'label      = "otherwise"',
        "label = [1]",
        "label = [1]",
        "number or a text",
    ),
    (
        "factor.case.label",
        'label      = "otherwise"',
        'label = "as she is"',
        "there twice",
        "Keep one",
    ),
    ("factor.case.set", '{ "other.u" = 1.5 }', '{ "other.u" = "1.5 s" }', "1.5 s", "m"),
    ("factor.case.events", "time = 1.0, bias", "time = 1.05, bias", "1.05 s is no multiple", "1"),
    ("factor.case.events", '{ "other.u" = 0.1 }', '{ "other.q" = 0.1 }', "'q'", "u, y"),
    (
        "factor.case.parameters",
        'parameters = ["lags.ssv"]',
        'parameters = ["legs"]',
        "'legs'",
        "lags",
    ),
    (
        "factor.case.components",
        'components = { other = "lag" }',
        'components = { other = "leg" }',
        "'leg'",
        "lag",
    ),
    (
        "factor.case.components",
        'components = { other = "lag" }',
        'components = { oter = "lag" }',
        "'oter'",
        "other",
    ),
    (
        "factor.case.stop_time",
        'stop_time  = "1 s"',
        'stop_time = "1.01 s"',
        "1.01 s is no multiple",
        "1 s",
    ),
    ("sample.method", 'method = "sobol"', 'method = "sobl"', 'method = "sobl"', "'sobol'"),
    ("sample.runs", "runs   = 2", "runs = 0.5", "runs = 0.5", "whole number"),
    (
        "sample.of",
        '[sample.of."other.time_constant"]',
        '[sample.of."other.constant"]',
        "constant",
        "time_constant",
    ),
    ("sample.of.distribution", '"uniform"', '"unifrm"', "no distribution 'unifrm'", "uniform"),
    ("sample.of.scale", "scale        = 50.0", "scal = 50.0", "unknown key 'scal'", "scale"),
    ("sample.of.scale", "scale        = 50.0", 'scale = "50 ms"', 'scale = "50 ms"', "number"),
    ("sample.of.unit", 'unit         = "ms"', 'unit = "mm"', "mm", "s"),
    (
        "sample.of.name",
        'name         = "sampled"',
        'name = "level"',
        "'level' is a factor already",
        "of its own",
    ),
    ("sample.of.at_fork", "at_fork      = false", "at_fork = 0", "at_fork = 0", "true or false"),
    (
        "sample.of.tolerance",
        "tolerance    = false",
        "tolerance = true",
        "either distribution or tolerance",
        "true",
    ),
    ("sample.of.also", 'also         = ["lag.noise"]', 'also = ["lag.nois"]', "'nois'", "noise"),
    (
        "sample.of.tolerance",
        'distribution = "norm"\ntolerance    = false',
        "tolerance = true",
        "No parameter set states a tolerance of other.noise",
        "",
    ),
    (
        "quantity",
        'reduce      = "maximum"',
        'reduce = "maximum"\nlimt = 3',
        "unknown key 'limt'",
        "limit",
    ),
    (
        "quantity.name",
        'name        = "highest"',
        'name = "the highest"',
        "'the highest' cannot name a column",
        "Use",
    ),
    ("quantity.description", '"the largest level"', "true", "description = true", "text"),
    ("quantity.signal", 'signal      = "lag.y"', 'signal = "leg.y"', "leg", "lag"),
    ("quantity.near", 'near   = [0.0, "10 cm"]', 'near = [0.0, "10 s"]', "10 s", "m"),
    ("quantity.reduce", '"maximum"', '"maximal"', 'reduce = "maximal"', "'maximum'"),
    (
        "quantity.during",
        'during      = ["0 s", "1 s"]',
        'during = ["5 s", "9 s"]',
        "beyond the end",
        "within",
    ),
    (
        "quantity.time",
        'time   = "1 s"',
        'time = "3 s"',
        "beyond the end of the runs at 2 s",
        "within",
    ),
    (
        "quantity.during",
        'during      = ["0 s", "1 s"]',
        'during = ["-1 s", "1 s"]',
        "before the runs",
        "within",
    ),
    (
        "quantity.expect",
        "at_most = 2.5 }]",
        "at_most = 2.5, during = [1.0, 9.0] }]",
        "beyond the end",
        "within",
    ),
    ("quantity.percentile", "percentile = 90.0", "percentile = 100.0", "100.0", "less than"),
    ("quantity.limit", 'limit  = "1 m"', 'limit = "1 kg"', "1 kg", "m"),
    (
        "quantity.since",
        'limit  = "1 m"',
        'limit = "1 m"\nsince = "3 s"',
        "beyond the end",
        "within",
    ),
    (
        "quantity.since",
        'reduce      = "maximum"',
        'reduce = "maximum"\nsince = 1.0',
        "since belongs to",
        "time_beyond",
    ),
    ("quantity.expect", "at_most = 2.5 }]", 'at_most = "2.5 kg" }]', "2.5 kg", "m"),
    (
        "quantity.expect",
        'expect = [{ signal = "lag.y"',
        'expect = [{ signal = "lag.x"',
        "'x'",
        "u, y",
    ),
    (
        "quantity.scenario_expectations",
        "scenario_expectations = true",
        "scenario_expectations = 1",
        "= 1",
        "true or",
    ),
    (
        "summary.name",
        'name        = "p90"',
        'name = "highest"',
        "'highest' is a quantity already",
        "of its own",
    ),
    (
        "summary.quantity",
        'quantity    = "highest"',
        'quantity = "higest"',
        "no quantity 'higest'",
        "highest",
    ),
    ("summary.over", 'over        = "seed"', 'over = "seeds"', "no factor 'seeds'", "seed"),
    (
        "summary.statistic",
        'statistic   = "percentile"',
        'statistic = "p90"',
        'statistic = "p90"',
        "'percentile'",
    ),
    ("summary.description", '"over the seeds"', "1", "description = 1", "text"),
    (
        "summary.percentile",
        "percentile  = 90.0",
        "percentile = 0.0",
        "percentile = 0.0",
        "greater than 0",
    ),
    ("summary.along", 'along     = "case"', 'along = "cases"', "no factor 'cases'", "case"),
    ("summary.share", "share     = 0.9", "share = 90.0", "share = 90.0", "less than or equal to 1"),
    ("summary.none", 'none      = "none"', "none = [1]", "none = [1]", "number or a text"),
    ("view.kind", 'kind  = "scatter"', 'kind = "scater"', 'kind = "scater"', "'scatter'"),
    ("view.title", 'title = "levels"', "title = 1", "title = 1", "text"),
    *((f"view.{key}", 'title = "levels"', f"{key} = 1", f"{key} = 1", "text") for key in TEXTS),
    ("view.x", 'x     = "level"', "", "needs x", ""),
    ("view.y", 'y     = "highest"', "y = 1", "y = 1", "text"),
    ("view.series", 'title = "levels"', "series = true", "series = true", "list"),
    ("view.only", 'title = "levels"', "only = { level = nan }", "nan", ""),
    ("view.static", 'title = "levels"', 'static = ["level 2"]', '"level 2"', "'level 1'"),
    ("view.circles", 'title = "levels"', "circles = [5.0, nan]", "circles.1 = nan", "finite"),
    ("view.circles", 'title = "levels"', "circles = [5.0]", "kind 'scatter' has no circles", ""),
    ("view.value", 'title = "levels"', "value = 1", "value = 1", "list"),
    ("view.most", 'title = "levels"', "most = 0", "most = 0", "greater than or equal to 1"),
    ("view.quantities", 'title = "levels"', 'quantities = ["level"]', "quantities", "more values"),
    ("view.largest", 'title = "levels"', "largest = 1", "largest = 1", "list"),
    ("tracks.signals", 'signals  = ["lag.y"]', 'signals = ["lag.z"]', "'z'", "u, y"),
    ("tracks.interval", 'interval = "0.2 s"', "interval = 0.0", "interval = 0.0", "greater than 0"),
]
SEARCHED = """
scenario = "filling"

[tune]
trials     = 8
population = 4

[tune.of."lag.u"]
low  = "50 cm"
high = 2.0
log  = false
name = "level"
also = ["other.u"]

[[tune.objective]]
quantity  = "highest"
direction = "maximise"
statistic = "mean"

[[tune.objective]]
quantity  = "off"
direction = "minimise"

[[quantity]]
name   = "highest"
signal = "lag.y"
reduce = "maximum"

[[quantity]]
name   = "off"
signal = "lag.y"
near   = 1.0
reduce = "final"
"""
OF_A_LOOP = 'name = "margin"\nmargin = "phase"\npeak_period = "6 s"\n'
MISTAKES_OF_SEARCHES = [
    ("tune", "trials     = 8", "trils = 8", "unknown key 'trils'", "trials"),
    (
        "tune",
        "[tune]",
        '[sample]\nruns = 2\nof."lag.noise".distribution = "norm"\n[tune]',
        "either [sample] or",
        "Take one out",
    ),
    ("tune.trials", "trials     = 8", "trials = 0", "trials = 0", "greater than or equal to 1"),
    (
        "tune.population",
        "population = 4",
        "population = 1",
        "population = 1",
        "greater than or equal to 2",
    ),
    ("tune.of", '[tune.of."lag.u"]', '[tune.of."lag.w"]', "'w'", "u"),
    ("tune.of.low", 'low  = "50 cm"', 'low = "50 kg"', "50 kg", "m"),
    ("tune.of.low", 'low  = "50 cm"', "low = 3.0", "low = 3 and high = 2", "smaller"),
    ("tune.of.high", "high = 2.0", "high = 0.9", "lag.u is 1 now", "Take a range that has it in"),
    ("tune.of.log", "log  = false", "log = 1", "log = 1", "true or false"),
    ("tune.of.name", 'name = "level"', 'name = "run"', "'run' is a column", "another name"),
    ("tune.of.also", 'also = ["other.u"]', 'also = ["other.w"]', "'w'", "u"),
    ("tune.objective.quantity", 'quantity  = "off"', 'quantity = "of"', "no quantity 'of'", "off"),
    (
        "tune.objective.direction",
        '"minimise"',
        '"minimize"',
        'direction = "minimize"',
        "'minimise'",
    ),
    ("tune.objective.statistic", '"mean"', '"median"', 'statistic = "median"', "'mean'"),
    (
        "quantity.margin",
        'reduce = "final"',
        f'reduce = "final"\n[[quantity]]\n{OF_A_LOOP}',
        "no DP controller",
        "none",
    ),
    (
        "quantity.component",
        'reduce = "final"',
        'reduce = "final"\ncomponent = "lag"',
        "component and peak_period belong to margin",
        "Give margin",
    ),
    (
        "quantity.peak_period",
        'reduce = "final"',
        'reduce = "final"\n[[quantity]]\nname = "m"\nmargin = "phase"',
        "peak_period is missing",
        '"6 s"',
    ),
]
PARAMETER_SET = """<?xml version="1.0" encoding="UTF-8"?>
<ssv:ParameterSet name="lags" version="1.0" xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues">
  <ssv:Parameters>
    <ssv:Parameter name="lag.time_constant"><ssv:Real value="1.5" unit="s"/></ssv:Parameter>
  </ssv:Parameters>
</ssv:ParameterSet>
"""


@pytest.fixture
def complaints(project, study):
    (project / "studies/lags.ssv").write_text(PARAMETER_SET)

    def of(text):
        with pytest.raises(ShipcosimError) as caught:
            plan_of(read_study(study(text)))
        return caught.value.problems

    return of


@pytest.mark.parametrize(
    ("whole", "key", "right", "wrong", "found", "remedy"),
    [(WHOLE, *one) for one in MISTAKES] + [(SEARCHED, *one) for one in MISTAKES_OF_SEARCHES],
)
def test_a_mistake_is_said_with_its_line(complaints, whole, key, right, wrong, found, remedy):
    assert whole.count(right) >= 1
    before, after = whole.split(right, 1) if right else ("", whole)
    text = before + wrong + after
    first = complaints(text)[0]
    line = int(re.fullmatch(r"\S*own\.toml, line (\d+).*", first.where)[1])
    own, last = before.count("\n") + 1, (before + wrong).count("\n") + 1
    head = max(
        (n for n, one in enumerate(text.split("\n")[:own], 1) if one.startswith("[")), default=own
    )
    assert own <= line <= last or line == head, f"line {own} of {key}: {first}"
    assert found in first.found, first
    assert remedy in f"{first.found} {first.remedy}".split(found, 1)[1], first


def test_the_study_without_a_mistake_is_laid_out(complaints, study):
    assert len(plan_of(read_study(study(WHOLE)))) == 2 * 2 * 2 * 3 * 2 * 2 * 2
    assert len(plan_of(read_study(study(SEARCHED)))) == 8


def test_every_key_of_a_study_is_among_the_mistakes():
    tried = {key for key, *_ in [*MISTAKES, *MISTAKES_OF_SEARCHES]}
    assert {
        key
        for key in keys_of(Study)
        if not any(one == key or one.startswith(f"{key}.") for one in tried)
    } == set()


def keys_of(record: type[BaseModel], before: str = ""):
    """Keys of a study file, of its tables too; events and expectations have tests of their own among scenarios."""
    for name, field in record.model_fields.items():
        key = before + (field.alias or name)
        yield key
        for part in parts_in(field.annotation):
            if part not in (Event, Expectation):
                yield from keys_of(part, f"{key}.")


def parts_in(annotation):
    if isinstance(annotation, type) and not isinstance(annotation, types.GenericAlias):
        return [annotation] if issubclass(annotation, BaseModel) else []
    return [part for inner in typing.get_args(annotation) for part in parts_in(inner)]


@pytest.mark.parametrize(
    ("values", "level"),
    [
        ("[2.0, 2.0]", "2.0"),
        ('["100 cm", 2.0, "1 m"]', "1.0"),
        ("[1, 1.0, 3.0]", "1.0"),
        ("[3.0, 2.0, 1.0, 2.0]", "2.0"),
    ],
)
def test_a_level_that_is_there_twice_is_refused(complaints, values, level):
    (first,) = complaints(WHOLE.replace('["100 cm", 2.0]', values))
    assert f"The level {level} is there twice." in first.found


@pytest.mark.parametrize(
    ("values", "is_refused"),
    [
        ('["-30 deg", "330 deg"]', True),
        ('["0 deg", "360 deg"]', True),
        ("[-3.141592653589793, 3.141592653589793]", True),
        ('["1 deg", "90 deg", "721 deg"]', True),
        ('["-30 deg", "30 deg"]', False),
        ('["0 deg", "359 deg"]', False),
    ],
)
def test_angles_a_turn_apart_are_one_direction(tmp_path, values, is_refused):
    text = DIRECTIONS.replace("VALUES", values)
    (tmp_path / "round.toml").write_text(text, encoding="utf-8")
    try:
        plan_of(read_study(tmp_path / "round.toml"))
        said = ""
    except ShipcosimError as error:
        said = str(error)
    assert ("rad are one direction. Keep one." in said) == bool(said) == is_refused


DIRECTIONS = """
description = "wind from all round"
scenario    = "gust"
stop_time   = "1 s"

[[factor]]
name   = "from"
signal = "environment.wind_from"
values = VALUES

[[quantity]]
name   = "end"
signal = "vessel.x"
reduce = "final"
"""


@pytest.mark.parametrize(
    ("after", "by"),
    [
        ('[[factor]]\nname = "later"\nsignal = "both.u"\nvalues = [5.0, 6.0]', "later"),
        (
            '[[factor]]\nname = "later"\n[[factor.case]]\nlabel = "a"\nset = {"both.u" = 3.0}\n'
            '[[factor.case]]\nlabel = "b"\nset = {"both.u" = 4.0, "lag.noise" = 0.1}',
            "later",
        ),
        ('[sample]\nruns = 4\n[sample.of."both.u"]\nname = "u"\ndistribution = "norm"', "u"),
    ],
)
def test_a_factor_of_which_every_value_is_replaced_is_refused(complaints, after, by):
    own = (
        'scenario = "filling"\n[[factor]]\nname = "level"\nsignal = "both.u"\nvalues = [1.0, 2.0]\n'
    )
    of_both = '[names]\nboth = ["lag", "other"]\n'
    taken = '[[quantity]]\nname = "y"\nsignal = "lag.y"\nreduce = "maximum"\n'
    (first,) = complaints(own + taken + after + "\n" + of_both)
    assert f"'{by}' sets lag.u too, so 'level' changes nothing." in first.found


def test_a_factor_that_is_replaced_in_some_runs_is_laid_out(complaints, study):
    text = WHOLE.replace('"other.u" = 1.5', '"other.u" = 1.5, "lag.u" = 1.5')
    assert text != WHOLE
    plan_of(read_study(study(text)))


@pytest.mark.parametrize("count", [10_001, 10**9, 10**18])
@pytest.mark.parametrize("key", ["seeds", "count"])
def test_more_levels_than_memory_holds_are_refused_at_once(complaints, key, count):
    text = re.sub(rf"(?m)^{key}( *)= \d+", rf"{key}\1= {count}", WHOLE)
    assert text != WHOLE
    assert "less than or equal to 10000" in complaints(text)[0].remedy
