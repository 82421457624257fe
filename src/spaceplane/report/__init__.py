"""What people see: tables, plots and the HTML report."""

from pathlib import Path


def write_report(out_dir: Path) -> Path:
    """Write report.html from the result.json and surface.vtp in `out_dir`; see `page.write_report`."""
    from spaceplane.report import page  # templates and VTK load only when a report is written

    return page.write_report(Path(out_dir))
