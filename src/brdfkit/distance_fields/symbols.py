"""Symbols that stand for numbers in a distance formula and record it as lines of GLSL."""

from typing import Any


class Program:
    """A GLSL program under construction: its lines, and the grids that it reads."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.grids: list[Any] = []

    def add_line(self, kind: str, expression: str) -> "Symbol":
        """Add a line that gives the `expression` a name, and return that name's `Symbol`."""
        name = f"v{len(self.lines)}"
        self.lines.append(f"{kind} {name} = {expression};")
        return Symbol(self, name, kind)

    def add_call(self, function: str, *args: Any) -> "Symbol":
        """Add a call of a GLSL function, and return the symbol of its value."""
        return self.add_line("float", f"{function}({', '.join(to_glsl(a) for a in args)})")

    def add_selection(self, condition: "Symbol", a: Any, b: Any) -> "Symbol":
        """Add a line that chooses `a` where the condition holds, else `b`; return its symbol."""
        return self.add_line("float", f"{condition.name} ? {to_glsl(a)} : {to_glsl(b)}")

    def read_grid_value(self, grid: Any, i: Any, j: Any, k: Any) -> "Symbol":
        """Add a line that reads the value (i, j, k) of a grid, and return its symbol.

        Each grid becomes a texture of its own.
        """
        if not any(grid is known for known in self.grids):
            self.grids.append(grid)
        number = next(n for n, known in enumerate(self.grids) if known is grid)
        indices = ", ".join(to_glsl(index, "int") for index in (i, j, k))
        return self.add_line("float", f"texelFetch(grid_{number}, ivec3({indices}), 0).r")


class Symbol:
    """A float, int or bool by its name in a GLSL program; arithmetic on it adds program lines."""

    def __init__(self, program: Program, name: str, kind: str = "float") -> None:
        self.program, self.name, self.kind = program, name, kind

    def _add_operation(self, sign: str, a: Any, b: Any, kind: str | None = None) -> "Symbol":
        """Add the line of a binary operation, and return the symbol of its result."""
        expression = f"{to_glsl(a, self.kind)} {sign} {to_glsl(b, self.kind)}"
        return self.program.add_line(kind or self.kind, expression)

    def __add__(self, other: Any) -> "Symbol":
        return self._add_operation("+", self, other)

    def __radd__(self, other: Any) -> "Symbol":
        return self._add_operation("+", other, self)

    def __sub__(self, other: Any) -> "Symbol":
        return self._add_operation("-", self, other)

    def __rsub__(self, other: Any) -> "Symbol":
        return self._add_operation("-", other, self)

    def __mul__(self, other: Any) -> "Symbol":
        return self._add_operation("*", self, other)

    def __rmul__(self, other: Any) -> "Symbol":
        return self._add_operation("*", other, self)

    def __truediv__(self, other: Any) -> "Symbol":
        return self._add_operation("/", self, other)

    def __rtruediv__(self, other: Any) -> "Symbol":
        return self._add_operation("/", other, self)

    def __neg__(self) -> "Symbol":
        return self._add_operation("-", 0.0, self)

    def __lt__(self, other: Any) -> "Symbol":
        return self._add_operation("<", self, other, "bool")

    def __gt__(self, other: Any) -> "Symbol":
        return self._add_operation(">", self, other, "bool")

    def __and__(self, other: Any) -> "Symbol":
        return self._add_operation("&&", self, other, "bool")

    def to_int(self) -> "Symbol":
        """Add a line that drops the fractional part of the number; return the integer's symbol."""
        return self.program.add_line("int", f"int({self.name})")


def to_glsl(value: Any, kind: str = "float") -> str:
    """Return the GLSL of a symbol, or of a number as a literal of the type `kind`."""
    if isinstance(value, Symbol):
        return value.name
    return repr(int(value)) if kind == "int" else repr(float(value))
