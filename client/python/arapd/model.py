"""The values that calls take and answer.

#V and #F are the vertices and triangles of a mesh, #U the positions of a layout, which has copies of
vertices along its cuts. Lengths are in the units of the mesh, angles in radians unless their name
says degrees. What a call takes as an array may be anything that numpy makes one of; arrays of
answers are numpy's, and read-only.
"""

from ._given import (DrawingOptions, Energy, FlattenOptions, GrainLine, Handle, Pin, Repair, ShapeOptions, Target,
                     Targets)
from ._told import (Chart, Compilation, Distortion, Drawing, DrawingFile, Event, Flattening, HandleSet, Job, MeshInfo,
                    OutlineMesh, Pick, PlacedHandle, Pong, Registration, Resumed, ServerInfo,
                    SessionInfo, SessionPage, Shape, UpdateError, Warning)

__all__ = [
    "Chart", "Compilation", "Distortion", "Drawing", "DrawingFile",
    "DrawingOptions", "Energy", "Event", "FlattenOptions", "Flattening", "GrainLine",
    "Handle", "HandleSet", "Job", "MeshInfo", "OutlineMesh", "Pick", "Pin", "PlacedHandle", "Pong",
    "Registration", "Repair", "Resumed", "ServerInfo", "SessionInfo", "SessionPage", "Shape",
    "ShapeOptions", "Target", "Targets", "UpdateError", "Warning",
]
