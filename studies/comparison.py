"""The table "paper / exact / FMU / difference" that each study prints."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """One number: what it is, the paper's entry as printed (None: the paper gives none), exact, and measured.

    Raises ValueError where the two cannot be compared: NaN would be left out of the largest difference."""

    quantity: str
    printed: str | None
    exact: float
    measured: float

    def __post_init__(self):
        if math.isnan(self.difference):
            raise ValueError(f"{self.quantity}: {self.measured} cannot be compared with {self.exact}")

    @property
    def difference(self) -> float:
        return self.measured - self.exact

    @property
    def misprinted(self) -> bool:
        """Whether the paper's entry is off by more than half a unit of its own last digit."""
        if self.printed is None:
            return False
        decimals = len(self.printed.partition(".")[2])
        # a hair above one half, for entries that end exactly there
        return abs(float(self.printed) - self.exact) > 0.500001 * 10.0**-decimals


class Comparison:
    """Rows under headings, printed aligned and within 100 columns."""

    def __init__(self):
        self._blocks: list[tuple[str, list[Row]]] = []

    def heading(self, text: str) -> None:
        """Start a block of rows."""
        self._blocks.append((text, []))

    def add(self, quantity: str, *, printed: str | None = None, exact: float, measured: float) -> None:
        """Add a row to the last block."""
        self._blocks[-1][1].append(Row(quantity, printed, exact, measured))

    @property
    def rows(self) -> list[Row]:
        """All rows, in order."""
        return [row for _, rows in self._blocks for row in rows]

    def text(self) -> str:
        """The table, with the worst difference of each block and a note on misprinted entries."""
        lines = [f"{'':<42} {'paper':>8}  {'exact':>15} {'FMU':>15} {'difference':>11}"]
        misprinted = False
        for heading, rows in self._blocks:
            worst = max(abs(row.difference) for row in rows)
            lines += ["", f"{heading:<84} {f'<= {worst:.1e}':>11}"]
            for row in rows:
                mark = "*" if row.misprinted else " "
                misprinted |= row.misprinted
                lines.append(
                    f"  {row.quantity:<40} {row.printed or '-':>8}{mark} {row.exact:>15.11f} "
                    f"{row.measured:>15.11f} {row.difference:>+11.1e}"
                )
        if misprinted:
            lines += ["", "* the paper's entry is not the exact value rounded to the digits it prints"]
        return "\n".join(lines)
