"""Damage to XML that mostly stays XML: entities, hostile values, depth, number, circles."""

from xml.etree import ElementTree

from fuzz.damage import VALUES, flipped, spliced, truncated

LAUGHS = (
    '<!DOCTYPE x [<!ENTITY a "ha">'
    + "".join(f'<!ENTITY {chr(98 + i)} "{f"&{chr(97 + i)};" * 20}">' for i in range(12))
    + "]>"
)
DOCTYPES = [
    LAUGHS,
    '<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]>',
    '<!DOCTYPE x SYSTEM "http://127.0.0.1:9/x.dtd">',
    '<!DOCTYPE x [<!ENTITY % p SYSTEM "file:///etc/passwd"> %p;]>',
    f'<!DOCTYPE x [<!ENTITY a "{"A" * 100_000}">]>',
    '<!DOCTYPE x [<!ATTLIST x name CDATA "y">]>',
]


def entities(rng, data):
    """With a document type and a reference to an entity."""
    head, _, body = data.partition(b"\n")
    doctype = rng.choice(DOCTYPES).encode()
    body = body.replace(
        b'name="', b'name="&' + rng.choice((b"a", b"l", b"m", b"zz")) + b";", rng.choice((0, 1))
    )
    return head + b"\n" + doctype + body


def tree_changed(rng, data):
    """Elements and attributes changed, lost, doubled, renamed, moved."""
    try:
        root = ElementTree.fromstring(data)
    except (ElementTree.ParseError, ValueError):
        return flipped(rng, data)
    for _ in range(rng.choice((1, 1, 2, 5))):
        _change_tree(rng, root)
    return ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True)


def _change_tree(rng, root):
    every = list(root.iter())
    element = rng.choice(every)
    change = rng.randrange(9)
    if change <= 2 and element.attrib:
        element.set(rng.choice(list(element.attrib)), rng.choice(VALUES))
    elif change == 3 and element.attrib:
        del element.attrib[rng.choice(list(element.attrib))]
    elif change == 4:
        names = {key for one in every for key in one.attrib}
        element.set(rng.choice([*names, "unknown"]), rng.choice(VALUES))
    elif change == 5:
        element.tag = rng.choice([*{one.tag for one in every}, "unknown", "{urn:x}y"])
    elif change == 6 and len(element):
        element.remove(rng.choice(list(element)))
    elif change == 7 and len(element):
        element.extend([rng.choice(list(element))] * rng.choice((1, 2, 50)))
    else:
        other = rng.choice(every)
        if element not in other.iter():
            element.append(other)


def deep(rng, data):
    """An element nested in itself."""
    try:
        root = ElementTree.fromstring(data)
    except (ElementTree.ParseError, ValueError):
        return truncated(rng, data)
    element = rng.choice(list(root.iter()))
    depth = rng.choice((20, 200, 300, 2000, 100_000))
    text = ElementTree.tostring(element).decode()
    tag, space = element.tag.rpartition("}")[2], element.tag.partition("}")[0].strip("{")
    name = rng.choice(VALUES[:8])
    wrapped = f'<q:{tag} xmlns:q="{space}" name="{name}">' * depth + text + f"</q:{tag}>" * depth
    return ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True).replace(
        text.encode(), wrapped.encode(), 1
    )


def nested_systems(rng, data):
    """Systems in systems, sound ones."""
    depth = rng.choice((5, 30, 120, 400))
    marks = b"<ssd:Elements>", b"</ssd:Elements>"
    if marks[0] not in data:
        return tree_changed(rng, data)
    start, end = data.index(marks[0]) + len(marks[0]), data.rindex(marks[1])
    opened = b"".join(b'<ssd:System name="s"><ssd:Elements>' for _ in range(depth))
    return (
        data[:start]
        + opened
        + b"</ssd:Elements></ssd:System>" * depth
        + data[start:end]
        + data[end:]
    )


def many(rng, data):
    """One element very often."""
    try:
        root = ElementTree.fromstring(data)
    except (ElementTree.ParseError, ValueError):
        return spliced(rng, data)
    parents = [one for one in root.iter() if len(one)]
    if not parents:
        return tree_changed(rng, data)
    parent = rng.choice(parents)
    child, count = rng.choice(list(parent)), rng.choice((100, 1000, 5000))
    renamed = rng.random() < 0.5
    for i in range(count):
        copy = ElementTree.Element(
            child.tag, {**child.attrib, **({"name": f"n{i}"} if renamed else {})}
        )
        copy.extend(list(child))
        parent.append(copy)
    return ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True)


def circles(rng, data):
    """Addresses that lead back, and connections that do."""
    changed = data
    for kind in (
        b'source="',
        b'startConnector="',
        b'endConnector="',
        b'startElement="',
        b'endElement="',
        b'dictionary="',
    ):
        parts = changed.split(kind)
        values = [part.partition(b'"')[0] for part in parts[1:]] + [
            b"SystemStructure.ssd",
            b"#top",
            b"resources/inner/inner.ssd",
        ]
        joined = parts[0]
        for part in parts[1:]:
            value, _, rest = part.partition(b'"')
            joined += kind + (rng.choice(values) if rng.random() < 0.4 else value) + b'"' + rest
        changed = joined
    return changed.replace(b"application/x-fmu-sharedlibrary", b"application/x-ssp-definition")


XML = (entities, tree_changed, tree_changed, tree_changed, deep, nested_systems, many, circles)
