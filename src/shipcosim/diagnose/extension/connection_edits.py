"""What an FMU of somebody else has no parameter for is carried by its connections: a factor, or an offset."""

from shipcosim.diagnose.ship.third_party_fmu import DRIVES, third_party_fmu_of
from shipcosim.series import conversion

__all__ = ["put_on_connections"]

_OFFSETS = {"rpm_offset": ("rpm", -1.0), "azimuth_offset": ("azimuth", 1.0)}


def put_on_connections(edits, finding, place, number, estimate):
    """Put a thruster's loss on its loads, or an offset on what drives it, where its FMU knows neither.

    Parameters
    ----------
    edits : StructureEdits
        Changed; a remark says what its connections have.
    finding : Finding
    place, number : str
        Component, and what is wrong with it.
    estimate : Estimate

    Returns
    -------
    bool
        Whether that was so.
    """
    system = edits.structure.checked()
    known = place in system.components and number in ("thrust_loss", *_OFFSETS)
    if not known or number in system.components[place].fmu.variables:
        return False
    one = third_party_fmu_of(system, place, edits.ship)
    if number == "thrust_loss":
        kept = 1.0 - _in(estimate, "1")
        wanted = [c for c in system.connections if c.source[0] == place and c.target[0] == edits.ship]
        new = [(c, kept * c.factor, kept * c.offset) for c in wanted]
        told = f"factor {kept:.3f} on the connections of its loads"
    else:
        kind, sign = _OFFSETS[number]
        off = sign * _in(estimate, DRIVES[kind])
        links = {link.variable: link for link in one.links if link.quantity == kind}
        wanted = [c for c in system.connections if c.target[0] == place and c.target[1] in links]
        new = [(c, c.factor, c.offset + links[c.target[1]].factor * off) for c in wanted]
        told = f"offset of {off:.4g} {DRIVES[kind]} on the connection of its {kind}"
    pairs = set(edits.structure.connections)
    if not new or any(_ends(c) not in pairs for c, *_ in new):
        edits.remark(finding, f"the connections of '{place}' are not in one system, so it is not carried")
        return True
    for one in new:
        _rejoin(edits.structure, system, *one)
    edits.remark(finding, f"carried as {told}")
    return True


def _in(estimate, unit):
    factor, offset = conversion(estimate.unit, unit)
    return factor * estimate.estimate + offset


def _ends(connection):
    """Names of what a connection joins."""
    ends = (connection.source, connection.target)
    return tuple(name if owner is None else f"{owner}.{name}" for owner, name in ends)


def _rejoin(structure, system, connection, factor, offset):
    """Connect the same ends with another factor and offset, conversion of units included."""
    source, target = _ends(connection)
    per, zero = conversion(_unit(system, connection.source), _unit(system, connection.target))
    structure.disconnect(source, target)
    structure.connect(source, target, factor=factor / per, offset=offset - factor / per * zero)


def _unit(system, end):
    owner, name = end
    return system.inputs[name].unit if owner is None else system.components[owner].fmu.variables[name].unit
