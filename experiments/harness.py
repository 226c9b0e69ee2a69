"""Shared by the experiments: running the program, running several trainings at a time, and tables."""
import argparse
import concurrent.futures
import hashlib
import json
import pathlib
import statistics
import subprocess
import tempfile

PROJECT = pathlib.Path(__file__).resolve().parent.parent
CANONPOSE = PROJECT / "build" / "canonpose"
# A run counts as mirrored if the depth mirrors of most of its poses fit the truth better than the poses do.
MIRRORED_PERCENT = 50.0
# The trap, a degenerate solution: depth is exaggerated up to threefold, or some poses are right and others mirrored, so that neither the
# network nor its mirror is a solution.
TRAP_DEPTH = 1.4
TRAP_MIRRORED_PERCENT = (5.0, 95.0)
# A solution is right if its poses are about as deep as the truth, and hardly any of them is mirrored.
RIGHT_DEPTH = (0.7, 1.4)
RIGHT_MIRRORED_PERCENT = 5.0


def require_build():
    if not CANONPOSE.exists():
        raise SystemExit("build the project first: ./run-demo or ./run-tests")


# The exit code of a computation whose result cannot be believed, and what `train` and `solve` then say of the file that they wrote.
DOUBTFUL = (4, "is written, but its 3D poses cannot be believed")


def run(*arguments):
    """Runs canonpose and returns what it printed. If it fails, its message ends the experiment. A training that is trapped or
    undecided is a result like any other, and so is a solution whose depth is a guess."""
    result = subprocess.run([str(CANONPOSE), *map(str, arguments)], capture_output=True, text=True)
    code, message = DOUBTFUL
    is_doubtful = arguments[0] in ("train", "solve") and result.returncode == code and message in result.stderr
    if result.returncode != 0 and not is_doubtful:
        raise SystemExit(f"canonpose {' '.join(map(str, arguments))}\n{result.stderr}")
    return result.stdout


def positive(text):
    """For argparse: a positive whole number."""
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"expected a positive whole number, found {text}")
    return int(text)


def add_train_options(parser, default):
    """Add this option last: everything after it goes to `train`."""
    parser.add_argument("--train-options", nargs=argparse.REMAINDER, default=default, metavar="OPTION",
                        help="must come last: all options after it go to every training, "
                             "as in --train-options --width 1024 --epochs 100")


def require_protocol(name):
    with tempfile.TemporaryDirectory() as folder:
        listed = pathlib.Path(folder) / "protocols.json"
        run("evaluate", "--list-protocols", "--json", listed)
        known = [protocol["name"] for protocol in json.loads(listed.read_text())["protocols"]]
    if name not in known:
        raise SystemExit(f"error: there is no protocol {name}; there are {', '.join(known)}")


def identity(path):
    """A file's path and a hash of its content, for the recipe of an experiment; None without a path."""
    if path is None:
        return None
    if not path.is_file():
        raise SystemExit(f"error: {path}: expected a dataset, found {'a folder' if path.is_dir() else 'nothing'}; check the path")
    with path.open("rb") as file:
        return [str(path), hashlib.file_digest(file, "sha256").hexdigest()]


def evaluate(run_folder, data, *options):
    report = run_folder / "evaluation.json"
    run("evaluate", run_folder, data, "--json", report, *options)
    return json.loads(report.read_text())


def evaluate_solved(solved, *options):
    report = solved.with_suffix(".evaluation.json")
    run("evaluate", solved, "--json", report, *options)
    return json.loads(report.read_text())


def train_and_evaluate(run_folder, train_data, test_data, preset, seed, settings, evaluate_options=()):
    """Trains once. Returns the figures on the test data, the mirror decision and the verdict on the trap."""
    run("train", *train_data, "-o", run_folder, "--preset", preset, "--seed", seed, "--threads", 1, *settings)
    info = json.loads(run("info", run_folder, "--json"))
    mirror, trap = info["mirror"], info["trap"]
    report = evaluate(run_folder, test_data, *evaluate_options)
    metrics = [json.loads(line) for line in (run_folder / "metrics.jsonl").read_text().splitlines()]
    return {"preset": preset, "seed": seed, "decision": mirror["decision"], "slope": mirror["slope"],
            "slope_error": mirror["slope_error"], "n_mpjpe": report["n_mpjpe_mm"], "p_mpjpe": report["p_mpjpe_mm"],
            "pck": report["pck150_percent"], "cps": report["cps"], "mirrored_percent": report["mirrored_percent"],
            "depth": report["depth_extent_ratio"], "validation": metrics[-1]["validation"], "loss": metrics[-1]["loss"],
            "steps": metrics[-1]["step"], "verdict": trap and trap["verdict"]}


def is_mirrored(result):
    return result["mirrored_percent"] > MIRRORED_PERCENT


def is_trapped(result):
    low, high = TRAP_MIRRORED_PERCENT
    return result["depth"] > TRAP_DEPTH or low < result["mirrored_percent"] < high


def is_right(result):
    low, high = RIGHT_DEPTH
    return low < result["depth"] < high and result["mirrored_percent"] < RIGHT_MIRRORED_PERCENT


def in_parallel(function, jobs, workers, output=None, recipe=""):
    """Results of function(*job) in the order of the jobs; each is printed when it is done. A job's first item is its name.

    With an output, results are also kept in OUTPUT.runs.jsonl, so that an experiment that was killed continues from there if its
    recipe is the same.
    """
    record = output.with_suffix(".runs.jsonl") if output else None
    done = {}
    if record and record.exists():
        lines = record.read_text().splitlines()
        if lines and json.loads(lines[0]) == recipe:
            done = {row["name"]: row["result"] for row in map(json.loads, lines[1:])}
    if record and not done:
        record.write_text(json.dumps(recipe) + "\n")

    def work(job):
        if job[0] in done:
            return done[job[0]]
        result = function(*job)
        if record:
            with record.open("a") as file:
                file.write(json.dumps({"name": job[0], "result": result}) + "\n")
        return result

    results = []
    with concurrent.futures.ThreadPoolExecutor(workers) as pool:
        for job, result in zip(jobs, pool.map(work, jobs)):
            shown = {key: round(value, 3) if isinstance(value, float) else value for key, value in result.items()}
            print(job[0], shown, flush=True)
            results.append(result)
    return results


def spread(values, digits=1):
    """Mean (lowest-highest)."""
    values = list(values)
    return f"{statistics.mean(values):.{digits}f} ({min(values):.{digits}f}-{max(values):.{digits}f})"


def split_clips(folder, every=5):
    """The motion capture clips of a folder: those to train on, and those held out, every fifth by default."""
    clips = sorted(path for path in folder.rglob("*") if path.suffix.lower() in (".amc", ".bvh"))
    held_out = clips[every - 1::every]
    return [clip for clip in clips if clip not in held_out], held_out


def seeds_of(results, condition):
    seeds = [str(result["seed"]) for result in results if condition(result)]
    return ", ".join(seeds) if seeds else "none"


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(map(str, row)) + " |" for row in rows])


def write(output, text, results):
    """Prints the text. With an output, writes it to OUTPUT.md and every run's figures to OUTPUT.json."""
    print("\n" + text)
    if output:
        output.with_suffix(".md").write_text(text)
        output.with_suffix(".json").write_text(json.dumps(results, indent=1))
