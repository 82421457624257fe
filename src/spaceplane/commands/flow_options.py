"""Options of `spaceplane flow` alone."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Body = Annotated[
    Path | None, typer.Argument(metavar="[BODY.stl]", help="Watertight body, metres; x aft, y right, z up.")
]
Mach = Annotated[str, typer.Option("--mach", metavar="M[,M...]", help="Mach numbers.")]
Area = Annotated[str, typer.Option("--area", metavar="M2", help="Reference area.")]
Length = Annotated[str, typer.Option("--length", metavar="M", help="Reference length of the pitching moment.")]
Span = Annotated[str, typer.Option("--span", metavar="M", help="Reference length of rolling and yawing moment.")]
MomentCenter = Annotated[str, typer.Option("--moment-center", metavar="x,y,z", help="Moment reference point, metres.")]
Alpha = Annotated[str, typer.Option("--alpha", metavar="DEG[,DEG...]", help="Angles of attack, degrees.")]
Beta = Annotated[
    str, typer.Option("--beta", metavar="DEG[,DEG...]", help="Sideslip, degrees, wind from the right positive.")
]
Method = Annotated[
    str,
    typer.Option(
        "--method",
        metavar="NAME",
        help="euler, or local inclination on the body's triangles (no mesh, from Mach 2): newtonian-expansion, "
        "newtonian, tangent, tangent-cone, tangent-wedge.",
    ),
]
Rates = Annotated[
    str, typer.Option("--rates", metavar="p,q,r", help="Steady roll, pitch and yaw rate about the moment point, rad/s.")
]
Domain = Annotated[
    str | None,
    typer.Option("--domain", metavar="x,y,z,x,y,z", help="Lower and upper corner of the air to mesh, metres."),
]
MeshFile = Annotated[
    Path | None,
    typer.Option(
        "--mesh",
        metavar="FILE",
        help="Body-fitted mesh (.su2 or .msh) instead of BODY.stl, metres; x aft, y right, z up. Coefficients are "
        "those of the walls in it: of half a body where it holds half.",
    ),
]
Wall = Annotated[str | None, typer.Option("--wall", metavar="NAME[,NAME...]", help="Markers of --mesh that are walls.")]
Far = Annotated[
    str | None, typer.Option("--far", metavar="NAME[,NAME...]", help="Markers of --mesh that are far field.")
]
Symmetry = Annotated[
    str | None,
    typer.Option("--symmetry", metavar="NAME[,NAME...]", help="Markers of --mesh that are planes of symmetry."),
]
Altitude = Annotated[
    str | None, typer.Option("--altitude", metavar="M", help="Altitude of the air, for friction, rates and --gas.")
]
Vtu = Annotated[Path | None, typer.Option("--vtu", metavar="FILE", help="Write the flow for ParaView.")]
Vtp = Annotated[
    Path | None, typer.Option("--vtp", metavar="FILE", help="Write the wall with its pressure for ParaView.")
]
