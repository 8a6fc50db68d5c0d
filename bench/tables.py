"""Markdown tables, and where the benchmark's results lie."""

from programs import BUILD

FOLDER = BUILD / "bench"


def markdown(header, rows):
    """A table whose first column is text and whose others are numbers."""
    lines = [header, ["---"] + ["---:"] * (len(header) - 1), *rows]
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def publish(text, name):
    """Prints a text of tables and keeps it as build/bench/results/NAME."""
    path = FOLDER / "results" / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    print(f"\n{text}\nWritten to {path.relative_to(BUILD.parent)}")
