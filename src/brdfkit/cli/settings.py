"""Reads NAME=VALUE behind options such as --set, --fixed and --bound."""

from brdfkit.core.errors import BrdfkitError


def parse_settings(words, option, *forms, free=False):
    """Name → value of words NAME=VALUE behind an `option`: a number, or a tuple of several.

    `forms`: what VALUE may be, in words such as VALUE or LOW,HIGH, which tell how many numbers;
    `free`: whether it may also be any number of numbers, true, false or a word.
    """
    found, forms = {}, forms or ("VALUE",)
    counts = [form.count(",") + 1 for form in forms]
    for word in words:
        name, _, text = word.partition("=")
        try:
            numbers = tuple(map(float, text.split(",")))
        except ValueError:
            numbers = ()
        if name and text and free and not numbers:
            found[name] = {"true": True, "false": False}.get(text, text)
        elif name and (len(numbers) in counts or (free and numbers)):
            found[name] = numbers[0] if len(numbers) == 1 else numbers
        else:
            should = " or ".join(f"{name or 'NAME'}={form}" for form in forms)
            decimals = len(numbers) == 2 and "." not in text and 1 in counts
            hint = f" Decimals take a point: {word.replace(',', '.')}." if decimals else ""
            raise BrdfkitError(
                f"{option} {word!r} should read {should}; repeat {option} for more.{hint}"
            )
    return found
