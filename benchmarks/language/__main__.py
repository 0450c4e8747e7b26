"""`python -m benchmarks.language [--ablations | --errors | --find | --free]`.

With `--predictions FILE`: `--evaluate DIR`, or `--gpsr SET --map MAP`.
"""

from __future__ import annotations

import argparse
import json
import os
from pathlib import Path
from typing import Any

from benchmarks.language import ablations, baseline, errors, finding, free, steps, trials
from benchmarks.language.scoring import Scores, scores
from benchmarks.table import Row, as_json, lines
from semmap.nodes.language.understanding.interpretation import shipped
from semmap.nodes.training.language import corpus
from semmap.nodes.training.language.corpus import Example

_REACH = {  # by ten folds, and with one of the folders left out
    "folds": (0.97, 0.93, 0.94, 0.91, 0.91, 0.96, 0.76),
    "groups": (0.88, 0.80, 0.82, 0.74, 0.76, 0.94, 0.52),
}
_WHAT = (
    "frames, micro F1",
    "arguments in right frames, span F1",
    "arguments in right frames, head F1",
    "arguments end to end, span F1",
    "arguments end to end, head F1",
    "grounding, F1",
    "whole command",
)


def _rows(title: str, found: Scores, reach: tuple[float, ...] | None = None) -> list[Row]:
    values = (
        found.frames,
        found.spans_in_right_frames,
        found.heads_in_right_frames,
        found.spans,
        found.heads,
        found.groundings,
        found.whole,
    )
    bounds = reach or (None,) * len(values)
    return [
        Row(f"{title}: {what}", value, "", bound, more=True)
        for what, value, bound in zip(_WHAT, values, bounds, strict=True)
    ]


def rows(examples: list[Example], with_ablations: bool) -> list[Row]:
    """Return all figures, on commands outside the training set."""
    found = _rows("ten folds", scores(trials.trial(trials.folds(examples))), _REACH["folds"])
    found += _rows("a folder left out", scores(trials.trial(trials.groups(examples))), _REACH["groups"])
    found += _rows("baseline", scores(baseline.pairs(trials.folds(examples))))
    _, ms = trials.read(examples, shipped())
    found.append(Row("a sentence, p50", ms, "ms", 5, 2))
    found += _rows("Italian", scores(trials.italian(examples)))
    found += finding.rows()
    if with_ablations:
        found += ablations.rows(examples)
    return found


def _evaluate(folder: Path, predictions: Path) -> Scores:
    """Parse every command of a folder with the shipped taggers, and write the results."""
    pairs, _ = trials.read(corpus.read(folder), shipped())
    said = [
        {
            "id": example.name,
            "frames": [
                {
                    "frame": frame.name,
                    "lexical_unit": list(frame.verb),
                    "arguments": [
                        {"role": a.role, "span": list(a.span), "head": a.head, "entity": a.entity}
                        for a in frame.arguments
                    ],
                }
                for frame in understood.frames
            ],
            "groundings": [{"token": g.token, "entity": g.entity} for g in understood.groundings],
        }
        for example, understood in pairs
    ]
    predictions.write_text(json.dumps(said, indent=1))
    return scores(pairs)


def main() -> None:
    """Print the table, or evaluate the shipped taggers on any folder."""
    parser = argparse.ArgumentParser(description=__doc__)
    data = Path(os.environ.get("SEMMAP_DATA", "../shared/data")) / "huric"
    parser.add_argument("--data", type=Path, default=data, help="the corpus: a folder of .hrc files")
    parser.add_argument("--ablations", action="store_true", help="also measure the contribution of each part")
    parser.add_argument("--errors", action="store_true", help="only list the wrong commands, grouped")
    parser.add_argument(
        "--evaluate", type=Path, metavar="DIR", help="evaluate the shipped taggers on these .hrc files"
    )
    parser.add_argument("--gpsr", type=Path, metavar="SET", help="write the steps of these commands")
    parser.add_argument("--map", type=Path, help="with --gpsr: the JSON scene of the map")
    parser.add_argument("--predictions", type=Path, metavar="FILE", help="file for the predictions")
    parser.add_argument("--find", action="store_true", help="only evaluate find")
    parser.add_argument("--free", action="store_true", help="only evaluate commands in free wording")
    parser.add_argument("--json", type=Path, metavar="FILE")
    given: Any = parser.parse_args()
    if (given.evaluate is None and given.gpsr is None) != (given.predictions is None):
        parser.error("--predictions FILE belongs to --evaluate DIR or --gpsr SET")
    if (given.gpsr is None) != (given.map is None):
        parser.error("--gpsr SET and --map MAP belong together")
    if given.gpsr is not None:
        predicted = steps.predict(given.gpsr, given.map)
        given.predictions.write_text(json.dumps(predicted, indent=1, ensure_ascii=False), "utf-8")
        print(f"{given.predictions}: {len(predicted)} commands")
        return
    if given.errors:
        wrong = errors.groups(trials.trial(trials.groups(corpus.read(given.data))))
        print(*errors.lines(wrong), sep="\n")
        return
    if given.evaluate is not None:
        found = _rows(str(given.evaluate), _evaluate(given.evaluate, given.predictions))
    elif given.free:
        found = free.measure()
    elif given.find:
        found = finding.rows()
    else:
        found = rows(corpus.read(given.data), given.ablations)
    print(lines(found))
    if given.json:
        given.json.write_text(json.dumps([as_json(row) for row in found], indent=1))


if __name__ == "__main__":
    main()
