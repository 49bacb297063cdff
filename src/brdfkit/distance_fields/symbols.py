"""Symbols: names of GLSL in the place of numbers, which write down what is computed with them."""


class Program:
    """The lines of GLSL that are written so far, and the grids from which they read."""

    def __init__(self):
        self.lines, self.grids = [], []

    def assign(self, kind, expression):
        """A line that names the `expression`; the `Symbol` of that name."""
        name = f"v{len(self.lines)}"
        self.lines.append(f"{kind} {name} = {expression};")
        return Symbol(self, name, kind)

    def call(self, function, *args):
        """The symbol of a function's value."""
        return self.assign("float", f"{function}({', '.join(text(a) for a in args)})")

    def select(self, condition, a, b):
        """The symbol of `a` where the condition holds, else `b`."""
        return self.assign("float", f"{condition.name} ? {text(a)} : {text(b)}")

    def texel(self, grid, i, j, k):
        """The symbol of the value (i, j, k) of a grid, which becomes a texture of its own."""
        if not any(grid is known for known in self.grids):
            self.grids.append(grid)
        number = next(n for n, known in enumerate(self.grids) if known is grid)
        indices = ", ".join(text(index, "int") for index in (i, j, k))
        return self.assign("float", f"texelFetch(grid_{number}, ivec3({indices}), 0).r")


class Symbol:
    """A name in a program of GLSL, of a float, an int or a bool."""

    def __init__(self, program, name, kind="float"):
        self.program, self.name, self.kind = program, name, kind

    def _with(self, sign, a, b, kind=None):
        expression = f"{text(a, self.kind)} {sign} {text(b, self.kind)}"
        return self.program.assign(kind or self.kind, expression)

    def __add__(self, other):
        return self._with("+", self, other)

    def __radd__(self, other):
        return self._with("+", other, self)

    def __sub__(self, other):
        return self._with("-", self, other)

    def __rsub__(self, other):
        return self._with("-", other, self)

    def __mul__(self, other):
        return self._with("*", self, other)

    def __rmul__(self, other):
        return self._with("*", other, self)

    def __truediv__(self, other):
        return self._with("/", self, other)

    def __rtruediv__(self, other):
        return self._with("/", other, self)

    def __neg__(self):
        return self._with("-", 0.0, self)

    def __lt__(self, other):
        return self._with("<", self, other, "bool")

    def __gt__(self, other):
        return self._with(">", self, other, "bool")

    def __and__(self, other):
        return self._with("&&", self, other, "bool")

    def to_int(self):
        """The symbol of this number, cut to a whole one."""
        return self.program.assign("int", f"int({self.name})")


def text(value, kind="float"):
    """A symbol, or a number of this kind, as GLSL writes it."""
    if isinstance(value, Symbol):
        return value.name
    return repr(int(value)) if kind == "int" else repr(float(value))
