"""Blocks and records by libasterix: every element with its path, its bits and its value."""

import asterix.base as base
import asterix.generated as generated


def blocks(data):
    """Blocks back to back: their octets."""
    at = 0
    while at < len(data):
        length = int.from_bytes(data[at + 1 : at + 3], "big")
        yield data[at : at + length]
        at += length


def elements(rule, path=()):
    """Every element under an item of libasterix: path, bits and value, None where it is no number."""
    node = getattr(rule, "arg", rule)
    if isinstance(rule, (base.NonSpare, base.Item)):
        yield from elements(node, path)
    elif isinstance(rule, (base.RuleVariation,)):
        yield from elements(node, path)
    elif isinstance(rule, base.Element):
        rule_of_content = rule._get_rule()
        # Where another element decides what the bits mean, only they are compared.
        is_free = isinstance(rule_of_content, base.RuleContentContextFree)
        content = rule_of_content._get_content() if is_free else None
        value = None
        if isinstance(content, base.ContentQuantity):
            value = content._as_quantity()
        elif isinstance(content, base.ContentInteger):
            value = content.as_integer() if hasattr(content, "as_integer") else content._as_integer()
        yield path, rule.as_uint(), value
    elif isinstance(rule, base.Explicit):
        yield path, rule.get_bytes().hex(), None
    elif isinstance(rule, base.Repetitive):
        for index, one in enumerate(rule.arg):
            yield from elements(one, path + (index,))
    elif isinstance(rule, base.Compound):
        for name, part in rule.arg.items():
            yield from elements(part, path + (name,))
    elif isinstance(rule, (base.Group, base.Extended)):
        parts = rule.arg if isinstance(rule, base.Group) else [part for octet in rule.arg for part in octet]
        for part in parts:
            if isinstance(part, base.Item):
                yield from elements(part, path + (part.arg.cv_name,))
    else:
        raise TypeError(type(rule))


def parse(octets, category, edition, profile):
    """The records of a block by libasterix."""
    spec = getattr(generated, f"Cat_{category:03}_{edition.replace('.', '_')}")
    bits = base.Bits.from_bytes(octets[3:])
    if issubclass(spec.cv_uap, base.UapMultiple):
        records = spec.cv_uap._parse(profile, bits)
    else:
        records = spec.cv_uap._parse(bits)
    if isinstance(records, ValueError):
        raise records
    return records
