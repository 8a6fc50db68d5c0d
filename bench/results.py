"""The CSV files of a benchmark: a row is appended as soon as it is measured, and found again
later."""

import csv
import datetime
import hashlib
import pathlib
import re

SETTINGS = ["width", "height", "max_depth", "rr_depth", "cores"]
SUBJECT = ["scene", "scene_id", "renderer", "version"]
RUN_KEY = [*SUBJECT, *SETTINGS, "seed", "spp"]
RUN_VALUES = ["real_spp", "seconds", "load", "peak_mib", "picture"]
START_KEY = [*SUBJECT, *SETTINGS, "cold", "repeat"]
START_VALUES = ["seconds"]


class Table:
    """Rows of text that a key identifies. Of two rows with the same key the later one counts."""

    def __init__(self, path, key, values):
        self.path, self.key, self.columns = path, key, [*key, *values, "when"]
        self.rows = {}
        if path.is_file():
            with open(path, newline="") as file:
                for row in csv.DictReader(file):
                    self.rows[self._key(row)] = row

    def _key(self, row):
        return tuple(str(row[column]) for column in self.key)

    def find(self, row):
        """The row with the same key, or None."""
        return self.rows.get(self._key(row))

    def add(self, row):
        now = datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds")
        row = {column: str(value) for column, value in {**row, "when": now}.items()}
        new = not self.path.is_file()
        with open(self.path, "a", newline="") as file:
            writer = csv.DictWriter(file, self.columns)
            if new:
                writer.writeheader()
            writer.writerow(row)
        self.rows[self._key(row)] = row


def runs_table(folder):
    return Table(folder / "runs.csv", RUN_KEY, RUN_VALUES)


def starts_table(folder):
    return Table(folder / "starts.csv", START_KEY, START_VALUES)


def scene_id(scene):
    """Identifies the content of a scene file and of the files that it names."""
    text = pathlib.Path(scene).read_text()
    digest = hashlib.sha256(text.encode())
    for name in sorted(set(re.findall(r'name="filename" value="([^"]+)"', text))):
        digest.update((scene.parent / name).read_bytes())
    return digest.hexdigest()[:12]


def subject(scene, renderer, settings):
    """The part of a row's key that says what is measured, and how."""
    return {"scene": scene.stem, "scene_id": scene_id(scene), "renderer": renderer.name,
            "version": renderer.version(),
            **{name: getattr(settings, name) for name in SETTINGS}}
