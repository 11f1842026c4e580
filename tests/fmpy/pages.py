"""Tables of the pages that say what an example prints."""

from pathlib import Path


def table(page: Path, head: str) -> dict[str, list[str]]:
    """Cells of each row by its first cell, of the table whose head begins with `head`; empty ones are left out."""
    lines = iter(page.read_text(encoding="utf-8").splitlines())
    for line in lines:
        if line.startswith(f"| {head} |"):
            break
    next(lines)
    rows = {}
    for line in lines:
        if not line.startswith("|"):
            break
        name, *cells = (cell.strip().replace("`", "") for cell in line.strip("|").split("|"))
        rows[name] = [cell for cell in cells if cell]
    return rows
