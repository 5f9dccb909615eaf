"""All commands in one place, and how their failures become one line and an exit status."""

from __future__ import annotations

import os
import sys

import typer

from app import __version__
from app.cli import (
    accounts,
    backup,
    battery,
    battery_ageing,
    battery_curve,
    battery_track,
    calibrate,
    check,
    compare,
    decode,
    drive,
    export,
    fit,
    fuel_model,
    observability,
    pose,
    process,
    reprocess,
    road,
    roadload,
    score,
    serve,
    simulate,
    simulate_battery,
    upload,
)
from app.cli.bench import command as bench
from app.errors import PonthyError
from app.science.errors import ScienceError

app = typer.Typer(
    name="ponthy",
    help="Each car's truth, from a cheap logger.",
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
EVERYTHING_AFTER = {"allow_extra_args": True, "ignore_unknown_options": True}
app.command("up")(serve.up)
app.command("test", context_settings=EVERYTHING_AFTER, add_help_option=False)(check.test)
app.command("simulate")(simulate.simulate)
app.command("simulate-battery")(simulate_battery.simulate_battery)
app.command("decode")(decode.decode)
app.command("process")(process.process)
app.command("calibrate")(calibrate.calibrate)
app.command("roadload")(roadload.roadload)
app.command("fit")(fit.fit)
app.command("fuel-model")(fuel_model.fuel_model)
app.command("compare")(compare.compare)
app.command("drive")(drive.drive)
app.command("battery")(battery.battery)
app.command("battery-curve")(battery_curve.battery_curve)
app.command("battery-ageing")(battery_ageing.battery_ageing)
app.command("battery-track")(battery_track.battery_track)
app.command("road")(road.road)
app.command("pose")(pose.pose)
app.command("score")(score.score)
app.command("bench")(bench.bench)
app.command("observability")(observability.observability)
app.command("upload")(upload.upload)
app.command("export")(export.export)
app.command("reprocess")(reprocess.reprocess)
app.command("backup")(backup.backup)
app.command("restore")(backup.restore)
app.add_typer(accounts.user, name="user")
app.add_typer(accounts.token, name="token")
app.command("web")(serve.web)
app.command("worker")(serve.worker)
app.command("warm")(serve.warm)


def print_version(wanted: bool) -> None:
    """Print the version and stop."""
    if wanted:
        print(f"ponthy {__version__}")
        raise typer.Exit


@app.callback()
def every_command(
    version: bool = typer.Option(False, "--version", callback=print_version, is_eager=True, help="Print the version."),
) -> None:
    """Each car's truth, from a cheap logger."""


def main(arguments: list[str] | None = None) -> int:
    """Run a command.

    Returns
    -------
    int
        0 when it worked, 1 when the work failed, 2 when the call's words are off, 130 when it was interrupted. The
        reason of a failure is one line on standard error; with ``PONTHY_DEBUG`` set, the whole traceback.
    """
    try:
        status = app(args=arguments, prog_name="./ponthy", standalone_mode=False)
    except typer.TyperException as error:
        context = getattr(error, "ctx", None)
        where = f" (see {context.command_path} --help)" if context else ""
        print(f"ponthy: {' '.join(error.format_message().split())}{where}", file=sys.stderr)
        return error.exit_code
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # or Python complains again when it ends
        return 1
    except Exception as error:  # the edge: whatever it was becomes one line
        if os.environ.get("PONTHY_DEBUG"):
            raise
        print(f"ponthy: {reason(error)}", file=sys.stderr)
        return 1
    return status if isinstance(status, int) else 0


def reason(error: Exception) -> str:
    """Return why something failed in one line; an error nobody foresaw is named by its kind."""
    text = " ".join(str(error).split())
    if isinstance(error, ScienceError | PonthyError | OSError):
        return text
    return f"{type(error).__name__}: {text} (set PONTHY_DEBUG=1 for the traceback)"
