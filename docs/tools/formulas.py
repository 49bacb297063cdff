"""Converts formulas of docstrings, plain lines such as `f = k_d / π`, to TeX for the pages.

Docstrings are read in a terminal, where TeX would be unreadable. In a line, factors side by side
bind closer than ` / `, which divides all factors before it by the one group after it:
`k_s (n + 2) / 2π c` is k_s (n + 2) / (2π) times c. A `/` without spaces divides the symbols that
touch it.
"""

import re

SYMBOLS = {
    **{"α": r"\alpha", "β": r"\beta", "γ": r"\gamma", "δ": r"\delta", "θ": r"\theta"},
    **{"μ": r"\mu", "π": r"\pi", "ρ": r"\rho", "σ": r"\sigma", "φ": r"\phi", "ω": r"\omega"},
    **{"Γ": r"\Gamma", "Δ": r"\Delta", "Σ": r"\sum", "∫": r"\int", "∇": r"\nabla", "·": r"\cdot"},
    **{"≈": r"\approx", "→": r"\to", "≤": r"\le", "≥": r"\ge", "Ē": r"\bar{E}", "∞": r"\infty"},
}
RAISED = dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻ⁿ", "0123456789+-n", strict=True))
LOWERED = dict(zip("₀₁₂₃₄₅₆₇₈₉₊₋", "0123456789+-", strict=True))
FUNCTIONS = "exp", "tan", "cos", "sin", "max", "min", "log"
CLOSING = {"(": ")", "[": "]", "{": "}"}
OPERATORS = "+-=<>,≈→≤≥"
NAMES = f"(?:{'|'.join(FUNCTIONS)})(?![a-z]{{2}})"  # matches `cos`, but not the start of `cosine`
TOKEN = re.compile(
    rf"\s+|{NAMES}|d(?=[a-zω]\b)|(?!{NAMES})[A-Za-z]{{2,}}(?: (?:a|(?!{NAMES})[a-z]{{2,}})\b)*"
    rf"|\d+(?:\.\d+)?|[{''.join(RAISED)}]+|[{''.join(LOWERED)}]+|_[A-Za-z0-9α-ω]*|."
)
BLOCK = re.compile(r"(?:^    .*\n?)+", re.MULTILINE)


def set_formulas(text):
    """Return a docstring's text with indented formulas as `$$ TeX $$`, and code unchanged."""
    return BLOCK.sub(_set_block, text)


def _set_block(match):
    block = match[0].rstrip("\n")
    if (
        '{"type"' in block
        or not re.search(" [=≈] ", block)
        or len(re.findall(r"\b[a-z]{3,}\b", block)) > 12
    ):
        return match[0]
    end = match[0][len(block) :]
    return "\n\n".join(f"$$\n{_set_line(line)}\n$$" for line in _join_continuations(block)) + end


def _join_continuations(block):
    """Return the lines of a block, each joined to the last one if it begins with an operator."""
    rows = []
    for line in block.splitlines():
        if rows and re.match(r"\s*[/·+\-]", line):
            rows[-1] += " " + line.strip()
        else:
            rows.append(line.strip())
    return rows


def _set_line(line):
    """Return the TeX of a line: an optional label, and formulas separated by two spaces or more."""
    label, formula = re.fullmatch(r"(?:([\w=]+)\s{2,})?(.*)", line).groups()
    parts = [
        rf"\text{{({part})}}" if re.fullmatch("[a-z_ ]{4,}", part) else to_tex(part)
        for part in re.split(r"\s{2,}", formula)
    ]
    return (rf"\text{{{label}:}}\quad " if label else "") + r"\qquad ".join(parts)


def to_tex(formula):
    r"""Return the TeX of one formula.

    >>> print(to_tex("f = k_d / π + k_s / 2π (cos α)ⁿ"))
    f = \frac{k_d}{\pi} + \frac{k_s}{2\pi}\, \left(\cos \alpha\right)^{n}
    """
    return _Reader(TOKEN.findall(formula)).read_sum()


class _Reader:
    """A parser that reads the tokens of a formula from left to right.

    Each method removes the tokens that it reads from the list, and returns their TeX. A group ends
    at the token `closing`.
    """

    def __init__(self, tokens):
        self.tokens = tokens

    def peek(self):
        return self.tokens[0] if self.tokens else ""

    def read_sum(self, closing=""):
        """Return the TeX of products and the operators between them, up to `closing`."""
        parts = []
        while self.tokens and self.peek() != closing:
            if self.peek() in OPERATORS:
                parts.append(SYMBOLS.get(self.peek(), self.peek()))
                self.tokens.pop(0)
            elif self.peek().isspace():
                self.tokens.pop(0)
            else:
                parts.append(self.read_product(closing))
        text = " ".join(parts).replace(" ,", ",")
        return re.sub(r"(^|\\left[(\[]|[=,]) *- ", r"\1 -", text).strip()

    def read_product(self, closing):
        """Return the TeX of factors side by side, with a fraction where ` / ` is between them."""
        done, factors = [], []
        while self.tokens and self.peek() != closing and self.peek() not in OPERATORS:
            token = self.peek()
            if token.isspace():
                self.tokens.pop(0)
            elif token in "/·":
                self.tokens.pop(0)
                if token == "·":
                    done += [*factors, r"\cdot"]
                else:
                    self.skip_space()
                    done.append(_make_fraction(r"\, ".join(factors), self.read_group(closing)))
                factors = []
            elif token in "Σ∫":
                done += [*factors, self.read_group(closing)]
                factors = []
            else:
                factors.append(self.read_group(closing))
        return r"\, ".join(done + factors).replace(r"\, \cdot\,", r" \cdot")

    def skip_space(self):
        while self.peek().isspace():
            self.tokens.pop(0)

    def read_group(self, closing):
        """Return the TeX of atoms without a space between them."""
        text = ""
        while self.tokens and self.peek() != closing and not self.peek().isspace():
            token = self.peek()
            if token in OPERATORS:
                break
            if token == "/":
                self.tokens.pop(0)
                return _make_fraction(text, self.read_group(closing))
            text = _join_pieces(text, self.read_atom())
            text += " " if token in FUNCTIONS else ""
            if token in FUNCTIONS and self.peek().isspace():
                self.skip_space()
        return text.strip()

    def read_atom(self):
        """Return the TeX of a symbol, number, word or bracket, with its sub- and superscripts."""
        token = self.tokens.pop(0)
        if token in CLOSING:
            inner = self.read_sum(CLOSING[token])
            self.tokens.pop(0)
            braces = (r"\{", r"\}") if token == "{" else (token, CLOSING[token])
            text = rf"\left{braces[0]}{inner}\right{braces[1]}"
        elif token == "√":
            text = rf"\sqrt{{{_strip_brackets(self.read_atom())}}}"
        elif token in FUNCTIONS:
            text = rf"\{token}"
        elif len(token) > 1 and token[:2].isalpha():
            text = rf"\text{{{token}}}" if token.isupper() else rf"\text{{ {token} }}"
        else:
            text = SYMBOLS.get(token, token) + (" " if token in SYMBOLS else "")
        return text.strip(" ") + self.read_scripts()

    def read_scripts(self):
        text = ""
        while self.tokens:
            token = self.peek()
            if token[0] in LOWERED:
                text += f"_{{{''.join(LOWERED[c] for c in token)}}}"
            elif token[0] in RAISED:
                text += f"^{{{''.join(RAISED[c] for c in token)}}}"
            elif token[0] == "_":
                text += _make_subscript(token[1:]) if token != "_" else ""
                if token == "_":  # _{...}
                    self.tokens[:2] = []
                    text += f"_{{{self.read_sum('}')}}}"
            elif token == "^":
                self.tokens.pop(0)
                minus = self.tokens.pop(0) if self.peek() == "-" else ""
                text += f"^{{{minus}{_strip_brackets(self.read_exponent())}}}"
                continue
            else:
                break
            self.tokens.pop(0)
        return text

    def read_exponent(self):
        """Return the TeX of an exponent, which is one bracket or one symbol."""
        if self.peek() == "{":
            self.tokens.pop(0)
            inner = self.read_sum("}")
            self.tokens.pop(0)
            return inner
        if self.peek() in CLOSING:
            return self.read_atom()
        token = self.tokens.pop(0)
        self.tokens[:0] = list(token[1:])  # only the first of several letters is the exponent
        return SYMBOLS.get(token[0], token[0])


def _join_pieces(left, right):
    """Return two pieces of TeX joined, with a space if a command would run into a letter."""
    runs_on = re.search(r"\\[a-zA-Z]+$", left) and right[:1].isalpha()
    return left + (" " if runs_on else "") + right


def _make_subscript(name):
    name = re.sub("|".join(map(re.escape, SYMBOLS)), lambda m: SYMBOLS[m[0]] + " ", name).strip()
    if len(name) == 1:
        return f"_{name}"
    return rf"_{{\text{{{name}}}}}" if len(name) > 4 and name.isalpha() else f"_{{{name}}}"


def _make_fraction(numerator, denominator):
    return rf"\frac{{{_strip_brackets(numerator)}}}{{{_strip_brackets(denominator)}}}"


def _strip_brackets(text):
    """Return TeX without round brackets that enclose all of it."""
    if not (text.startswith(r"\left(") and text.endswith(r"\right)")):
        return text
    depth = 0
    for mark in re.finditer(r"\\left\W|\\right\W", text):
        depth += 1 if mark[0].startswith(r"\left") else -1
        if depth == 0:
            return text[len(r"\left(") : -len(r"\right)")] if mark.end() == len(text) else text
    return text
