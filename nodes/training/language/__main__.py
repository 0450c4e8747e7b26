"""Train the taggers for commands on the HuRIC corpus: `python -m semmap.nodes.training.language FOLDER`."""

from __future__ import annotations

import argparse
from importlib import resources
from pathlib import Path
from typing import Final

from semmap.nodes.training.language import corpus, made
from semmap.nodes.training.language.household import household
from semmap.nodes.training.language.learning import learn

TIMES_MADE: Final = 2  # how often each pattern of ours is drawn


def main() -> None:
    """Write the trained taggers to the folder of `semmap.nodes.language`."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="the corpus: a folder of .hrc files")
    folder = parser.parse_args().folder
    known = household()
    examples = [*corpus.read(folder), *made.examples(TIMES_MADE, known)]
    target = Path(str(resources.files("semmap.nodes.language"))) / "learnt"
    target.mkdir(exist_ok=True)
    learn(examples, known, target / "english_frames.crfsuite", target / "english_roles.crfsuite")
    print(f"learnt from {len(examples)} commands: {target}")


if __name__ == "__main__":
    main()
