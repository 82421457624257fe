"""STEP export of the vehicle's parts as smooth solids through OpenCASCADE (optional extra `step`).

The parts are lofted through the same sections as the triangulated ones, at a coarser spacing, and left unfused: fusing
them in OpenCASCADE takes seconds and is not reliable. Bays are not cut, so that each flap lies in its wing.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from spaceplane.errors import InputError
from spaceplane.vehicle.controls import ControlDeflections
from spaceplane.vehicle.export import part_colour, prepare_output
from spaceplane.vehicle.flaps import body_flap_hinge, elevon_hinge, flap_grid, rudder_hinge
from spaceplane.vehicle.fuselage import fuselage_grid, nose_tip
from spaceplane.vehicle.layout import Layout
from spaceplane.vehicle.shape import ShapeParameters
from spaceplane.vehicle.wing import wing_grid

SPACING = 0.25  # m between section points
MAX_STATIONS = 48  # sections per part: more make files large and lofts slow


def write_step(shape: ShapeParameters, deflections: ControlDeflections | None, path: str | Path) -> Path:
    """Write the vehicle as a STEP compound of named, unfused solids; metres in the model, millimetres in the file.

    Args:
        shape: shape parameters.
        deflections: of the control surfaces, rad; none if omitted.
        path: file that ends in .step.

    Raises:
        InputError: the extra is not installed, or the file cannot be written.
    """
    path = prepare_output(path, ".step")
    try:
        import OCP  # noqa: F401
    except ImportError as err:
        raise InputError(
            f"output file '{path}': STEP needs the optional extra, install it with pip install 'spaceplane[step]'"
        ) from err
    grids = part_grids(shape, deflections or ControlDeflections())
    tip = nose_tip(Layout(shape))
    solids = {
        name: _solid(grid, tip if name == "fuselage" else None, smooth=name.startswith(("fuselage", "wing")))
        for name, grid in grids.items()
    }
    _write(solids, path)
    return path


def part_grids(shape: ShapeParameters, deflections: ControlDeflections) -> dict[str, np.ndarray]:
    """Sections of every part, name -> [station, point, xyz] in m.

    Fuselage sections are closed curves; those of the others run from one corner of the trailing edge to the other.
    """
    layout = Layout(shape)
    spacing = SPACING
    grids = {"fuselage": fuselage_grid(layout, spacing)}
    wing = wing_grid(layout, spacing)
    surfaces = {
        "wing": (wing, wing),
        "elevon": tuple(
            flap_grid(elevon_hinge(layout), a, spacing) for a in (deflections.elevon_left, deflections.elevon_right)
        ),
        "rudder": tuple(
            flap_grid(rudder_hinge(layout), a, spacing) for a in (deflections.rudder_left, deflections.rudder_right)
        ),
    }
    for name, (left, right) in surfaces.items():
        grids[f"{name}_left"] = left * [1.0, -1.0, 1.0]
        grids[f"{name}_right"] = right
    grids["body_flap"] = flap_grid(body_flap_hinge(layout), deflections.body_flap, spacing)
    return grids


def _thinned(grid: np.ndarray) -> np.ndarray:
    """At most `MAX_STATIONS` stations, first and last kept."""
    if len(grid) <= MAX_STATIONS:
        return grid
    return grid[np.unique(np.linspace(0, len(grid) - 1, MAX_STATIONS).round().astype(int))]


def _solid(grid: np.ndarray, tip: np.ndarray | None, smooth: bool):
    """OpenCASCADE solid of two skins through the sections, the strips between them, and ruled ends.

    Args:
        grid: [station, point, xyz], m; closed sections if `tip` is given.
        tip: [xyz] point in which closed sections end at the front.
        smooth: cubic skins; else flat between the points (for flaps, where knuckle and wedge meet).
    """
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeSolid, BRepBuilderAPI_Sewing
    from OCP.BRepLib import BRepLib
    from OCP.TopAbs import TopAbs_SHELL
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    grid = 1000.0 * _thinned(grid)
    if tip is not None:
        grid = np.concatenate([np.broadcast_to(1000.0 * tip, (1, *grid.shape[1:])), grid])
        half = grid.shape[1] // 2
        skins = (grid[:, : half + 1], np.concatenate([grid[:, half:], grid[:, :1]], axis=1)[:, ::-1])
    else:
        half = (grid.shape[1] - 1) // 2
        skins = (grid[:, : half + 1], grid[:, half:][:, ::-1])
    first, second = (_surface(skin, smooth) for skin in skins)
    sewing = BRepBuilderAPI_Sewing(1.0)
    for face in _faces(first, second, pointed=tip is not None):
        sewing.Add(face)
    sewing.Perform()
    shells = TopExp_Explorer(sewing.SewedShape(), TopAbs_SHELL)
    solid = BRepBuilderAPI_MakeSolid(TopoDS.Shell_s(shells.Current())).Solid()
    BRepLib.OrientClosedSolid_s(solid)
    return solid


def _faces(first, second, pointed: bool) -> list:
    """Both skins, ruled faces between their ends, and the trailing-edge strip of an open section."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace
    from OCP.BRepFill import BRepFill

    faces = [BRepBuilderAPI_MakeFace(s, 1e-3).Face() for s in (first, second)]
    low_u, high_u, low_v, _ = first.Bounds()
    ends = [high_u] if pointed else [low_u, high_u]
    pairs = [(first.UIso(u), second.UIso(u)) for u in ends]
    if not pointed:
        pairs.append((first.VIso(low_v), second.VIso(low_v)))
    for one, other in pairs:
        faces.append(BRepFill.Face_s(BRepBuilderAPI_MakeEdge(one).Edge(), BRepBuilderAPI_MakeEdge(other).Edge()))
    return faces


def _surface(grid: np.ndarray, smooth: bool):
    """B-spline surface through a grid of points, [station, point, xyz] in mm: cubic, or flat between the points."""
    from OCP.Geom import Geom_BSplineSurface
    from OCP.GeomAPI import GeomAPI_PointsToBSplineSurface
    from OCP.gp import gp_Pnt
    from OCP.TColgp import TColgp_Array2OfPnt

    points = TColgp_Array2OfPnt(1, grid.shape[0], 1, grid.shape[1])
    for i, row in enumerate(grid):
        for j, p in enumerate(row):
            points.SetValue(i + 1, j + 1, gp_Pnt(*p))
    if smooth:
        fit = GeomAPI_PointsToBSplineSurface()
        fit.Interpolate(points)
        return fit.Surface()
    (u_knots, u_counts), (v_knots, v_counts) = (_linear_knots(n) for n in grid.shape[:2])
    return Geom_BSplineSurface(points, u_knots, v_knots, u_counts, v_counts, 1, 1)


def _linear_knots(count: int):
    """Knots and multiplicities of a B-spline of degree 1 through `count` points."""
    from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal

    knots, multiplicities = TColStd_Array1OfReal(1, count), TColStd_Array1OfInteger(1, count)
    for i in range(1, count + 1):
        knots.SetValue(i, float(i))
        multiplicities.SetValue(i, 2 if i in (1, count) else 1)
    return knots, multiplicities


def _write(solids: dict, path: Path) -> None:
    """Write named, coloured solids as one STEP assembly."""
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.Message import Message, Message_Gravity
    from OCP.Quantity import Quantity_Color, Quantity_TOC_RGB
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_ColorSurf, XCAFDoc_DocumentTool

    for printer in Message.DefaultMessenger_s().Printers():
        printer.SetTraceLevel(Message_Gravity.Message_Fail)  # transfer statistics are no news to the user
    document = TDocStd_Document(TCollection_ExtendedString("spaceplane"))
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    colours = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    for name, solid in solids.items():
        label = shapes.AddShape(solid, False)
        TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
        colours.SetColor(label, Quantity_Color(*part_colour(name), Quantity_TOC_RGB), XCAFDoc_ColorSurf)
    writer = STEPCAFControl_Writer()
    writer.Transfer(document)
    if writer.Write(str(path)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise InputError(f"output file '{path}': OpenCASCADE could not write it")
