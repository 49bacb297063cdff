"""Names that stay apart."""


def unused(name, taken):
    """`name`, numbered where it is among `taken`: "ward", "ward (2)".

    >>> unused("ward", {"ward"})
    'ward (2)'
    """
    number, result = 1, name
    while result in taken:
        number += 1
        result = f"{name} ({number})"
    return result
