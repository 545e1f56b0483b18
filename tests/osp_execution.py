"""libcosim as its own users start it: from its configuration file, with its own scenario file."""


def rows_of(structure, system, n_steps, scenario=None):
    """Values of all outputs of a kind that libcosim hands out, after every step.

    Parameters
    ----------
    structure : path
        OspSystemStructure.xml, or a folder with one.
    system : System
        Whose outputs are asked for; names of simulators are those of its components.
    n_steps : int
        Steps to make.
    scenario : path, optional
        Of OSP.

    Returns
    -------
    dict of str to list
        By ``component.variable``, at h, 2 h, ...
    """
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver

    execution = CosimExecution.from_osp_config_file(str(structure))
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    if scenario:
        manager = CosimManipulator.create_scenario_manager()
        assert execution.add_manipulator(manager) and execution.load_scenario(
            manager, str(scenario)
        )
    calls = {
        kind: getattr(observer, f"last_{kind.lower()}_values")
        for kind in ("Real", "Integer", "Boolean")
    }
    outputs = [
        (name, execution.slave_index_from_instance_name(name), kind, variables)
        for name, component in system.components.items()
        for kind in calls
        if (
            variables := [
                v
                for v in component.fmu.variables.values()
                if (v.causality, v.kind) == ("output", kind)
            ]
        )
    ]
    rows = {f"{name}.{v.name}": [] for name, _, _, variables in outputs for v in variables}
    for _ in range(n_steps):
        assert execution.step()
        for name, index, kind, variables in outputs:
            values = calls[kind](index, [v.value_reference for v in variables])
            for variable, value in zip(variables, values, strict=True):
                rows[f"{name}.{variable.name}"].append(value)
    return rows


def assert_same(table, rows):
    """A table of ours has these very digits at the end of every step."""
    for signal, values in rows.items():
        assert table[signal].values[1:].tolist() == values, signal
