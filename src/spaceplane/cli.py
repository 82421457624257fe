"""The door: `spaceplane COMMAND`. Commands parse, call one stage and print; they compute nothing themselves."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Annotated

import typer

from spaceplane import __version__
from spaceplane.commands import analyse, compare, database, export, flow, fly, geometry, modes, report, study, validate
from spaceplane.commands.arguments import naming_options, require_places, spread_assignments
from spaceplane.errors import InputError

GOOD, NOT_GOOD, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130
# typer carries its own copy of click in some versions and imports it in others: reach its base error through typer.
_CommandLineError: type[Exception] = typer.BadParameter.__mro__[2]

app = typer.Typer(
    name="spaceplane",
    help="From the shape of a winged re-entry vehicle to its flying qualities.",
    epilog="First steps: spaceplane analyse horus-2b --out out/horus-2b",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.command("analyse", epilog=analyse.EXAMPLE)(naming_options(analyse.analyse))
app.command("geometry", epilog=geometry.EXAMPLE)(geometry.geometry)
app.command("flow", epilog=flow.EXAMPLE)(naming_options(flow.flow))
app.command("database", epilog=database.EXAMPLE)(naming_options(database.database))
app.command("fly", epilog=fly.EXAMPLE)(fly.fly)
app.command("modes", epilog=modes.EXAMPLE)(modes.modes)
app.add_typer(study.app, name="study")
app.command("compare", epilog=compare.EXAMPLE)(compare.compare)
app.command("report", epilog=report.EXAMPLE)(report.report)
app.command("validate", epilog=validate.EXAMPLE)(validate.validate)
app.command("export", epilog=export.EXAMPLE)(export.export)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"spaceplane {__version__}")
        raise typer.Exit()


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


def run(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code: 0 good, 1 a result that is not good, 2 bad input, 130 Ctrl-C."""
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    try:
        require_places(arguments)
        code = app(args=spread_assignments(arguments), prog_name="spaceplane", standalone_mode=False)
    except InputError as error:
        return _complain(str(error), BAD_INPUT)
    except _CommandLineError as error:
        if type(error).__name__ == "NoArgsIsHelpError":  # click printed the help already
            return BAD_INPUT
        return _complain(error.format_message(), BAD_INPUT)  # type: ignore[attr-defined]
    except BrokenPipeError:
        sys.stderr.close()  # the reader went away, as `| head` does
        return NOT_GOOD
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        return _complain(f"{where}{error.strerror or error}", BAD_INPUT)
    except MemoryError:
        return _complain("not enough memory; choose a larger --cell or fewer --cells", NOT_GOOD)
    except (KeyboardInterrupt, typer.Abort):
        return _complain("interrupted", INTERRUPTED)
    if code == INTERRUPTED:
        return _complain("interrupted", INTERRUPTED)
    return code if isinstance(code, int) else GOOD


def _complain(text: str, code: int) -> int:
    print("error: " + " ".join(text.split()), file=sys.stderr)
    return code


def main() -> None:
    """Entry point of the `spaceplane` command."""
    sys.exit(run())


if __name__ == "__main__":
    main()
