"""What a session can do, once for both ways of waiting; see _api.py."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from . import _answers, _calls, _programs, _requests, _shapes, _ways, _wire, model
from ._api import JobMethods
from ._calls import CallOptions, Method, Program
from ._requests import message

_LOOK_UP = ("DeformationService", _calls.QUICK_LIMIT, "harmless")
_REMOVE = ("DeformationService", _calls.QUICK_LIMIT, "removal")
_WORK = ("DeformationService", _calls.WORK_LIMIT, "harmless")
_CHANGE = ("DeformationService", _calls.WORK_LIMIT, "never")


class SessionMethods(JobMethods):
    """A namespace of meshes, handle sets and jobs on the server, which expires when unused.

    Sessions remember the sizes of the meshes that they have registered or got, and every shape must
    have as many vertices as its mesh. Of a mesh that was never seen shapes may be of any size."""

    def __init__(self, session_id: str):
        self.id = session_id
        self._sizes = _answers.KnownSizes()

    def _ask(self, name: str, kind: tuple[str, float, str], call: dict[str, Any],
             **fields: Any) -> Program[Any]:
        """One unary call of the session; answers its message."""
        request = message(f"{name}Request")(session_id=self.id, **fields)
        method = Method(kind[0], name, kind[1], kind[2])
        return _calls.call(method, request, message(f"{name}Response"), CallOptions(**call), self.id)

    @_ways.call
    def info(self, /, **call: Any) -> Program[model.SessionInfo]:
        """What the session holds: a SessionInfo. Does not extend its life."""
        def program() -> Program[model.SessionInfo]:
            answer = yield from self._ask("GetSession", _LOOK_UP, call)
            return _answers.session_info(answer.session, self.id)
        return program()

    @_ways.call
    def delete(self, /, **call: Any) -> Program[None]:
        """Ends the session; its open streams end with NOT_FOUND."""
        def program() -> Program[None]:
            yield from self._ask("DeleteSession", _REMOVE, call)
        return program()

    @_ways.call
    def register_mesh(self, /, vertices: Any, triangles: Any, mesh_id: str = "", *,
                      energy: model.Energy = model.Energy(), repair: model.Repair = model.Repair(),
                      **call: Any) -> Program[model.Registration]:
        """Mends, checks and factors a mesh of #V×2 vertices and #F×3 triangles: a Registration.
        Without an id it has one made of its content."""
        fields: dict[str, Any] = {"mesh": message("PlanarMesh")(),
                                  "energy": message("EnergyOptions")()}
        _requests.set_mesh(fields["mesh"], vertices, triangles, 2)
        _requests.set_energy(fields["energy"], energy)
        repairs = message("RegisterMeshRequest")()
        _requests.set_repair(repairs, repair)
        if repairs.HasField("repair"):
            fields["repair"] = repairs.repair
        size = _answers.MeshSize(len(vertices), len(triangles))

        def program() -> Program[model.Registration]:
            answer = yield from self._ask("RegisterMesh", _WORK, call, mesh_id=mesh_id, **fields)
            mesh = _answers.mesh_info(answer.mesh, mesh_id or None, size)
            self._sizes.know(mesh.id, size)
            return model.Registration(mesh, answer.shared, _answers.seconds(answer.queue_time),
                                      _answers.seconds(answer.solve_time))
        return program()

    @_ways.call
    def get_mesh(self, /, mesh_id: str, **call: Any) -> Program[model.MeshInfo]:
        """What is known of a mesh: a MeshInfo."""
        def program() -> Program[model.MeshInfo]:
            answer = yield from self._ask("GetMesh", _LOOK_UP, call, mesh_id=mesh_id)
            mesh = _answers.mesh_info(answer.mesh, mesh_id, None)
            self._sizes.know(mesh_id, _answers.MeshSize(mesh.vertex_count, mesh.triangle_count))
            return mesh
        return program()

    @_ways.call
    def delete_mesh(self, /, mesh_id: str, **call: Any) -> Program[None]:
        """Forgets a mesh and the handle sets on it."""
        def program() -> Program[None]:
            yield from self._ask("DeleteMesh", _REMOVE, call, mesh_id=mesh_id)
            self._sizes.forget(mesh_id)
        return program()

    @_ways.call
    def compile_handles(self, /, handle_set_id: str, mesh_id: str, handles: Sequence[model.Handle],
                        **call: Any) -> Program[model.Compilation]:
        """Compiles a handle set on a mesh: a Compilation."""
        ids = [handle.id for handle in handles]
        messages = [self._handle(handle) for handle in handles]

        def program() -> Program[model.Compilation]:
            answer = yield from self._ask("CompileHandles", _WORK, call, mesh_id=mesh_id,
                                          handle_set_id=handle_set_id, handles=messages)
            return self._compiled(answer, handle_set_id, mesh_id, ids, True)
        return program()

    @_ways.call
    def edit_handles(self, /, handle_set_id: str, remove: Sequence[str] = (),
                     add: Sequence[model.Handle] = (), **call: Any) -> Program[model.Compilation]:
        """Removes handles first, then adds: a Compilation. Nothing changes when it fails."""
        ids = [handle.id for handle in add]
        messages = [self._handle(handle) for handle in add]

        def program() -> Program[model.Compilation]:
            answer = yield from self._ask("EditHandles", _CHANGE, call, remove=list(remove),
                                          handle_set_id=handle_set_id, add=messages)
            return self._compiled(answer, handle_set_id, None, ids, False)
        return program()

    @staticmethod
    def _handle(handle: model.Handle) -> Any:
        out = message("Handle")()
        _requests.set_handle(out, handle)
        return out

    def _compiled(self, answer: Any, handle_set_id: str, mesh_id: str | None, last: list[str],
                  all_of_them: bool) -> model.Compilation:
        handle_set = _answers.handle_set(answer.handle_set, handle_set_id, mesh_id, self._sizes,
                                         last, all_of_them)
        return model.Compilation(handle_set, _answers.seconds(answer.queue_time),
                                 _answers.seconds(answer.solve_time))

    @_ways.call
    def get_handle_set(self, /, handle_set_id: str, **call: Any) -> Program[model.HandleSet]:
        """What is known of a handle set: a HandleSet."""
        def program() -> Program[model.HandleSet]:
            answer = yield from self._ask("GetHandleSet", _LOOK_UP, call,
                                          handle_set_id=handle_set_id)
            return _answers.handle_set(answer.handle_set, handle_set_id, None, self._sizes, [])
        return program()

    @_ways.call
    def delete_handle_set(self, /, handle_set_id: str, **call: Any) -> Program[None]:
        """Forgets a handle set."""
        def program() -> Program[None]:
            yield from self._ask("DeleteHandleSet", _REMOVE, call, handle_set_id=handle_set_id)
            self._sizes.forget_set(handle_set_id)
        return program()

    @_ways.call
    def deform(self, /, handle_set_id: str, targets: model.Targets,
               options: model.ShapeOptions = model.ShapeOptions(), *, picks: Any = None,
               **call: Any) -> Program[model.Shape]:
        """One target for every handle of the set: a Shape. `picks`: n×2 points of it, at most 1024, to
        find at rest."""
        points = _requests.point_array([] if picks is None else picks, 2, "picks")
        messages = [_requests.target_message(*item)
                    for item in _requests.targets_of(targets).items()]
        wanted = message("DeformOptions")()
        _requests.set_shape_options(wanted, options)

        def program() -> Program[model.Shape]:
            answer = yield from self._ask("Deform", _WORK, call, handle_set_id=handle_set_id,
                                          targets=messages, options=wanted,
                                          pick_points=_wire.packed(points))
            question = _shapes.Question(options, self._sizes.of_set(handle_set_id))
            question.told(answer.vertices)
            return _shapes.shape(answer.shape, question, len(points))
        return program()

    @_ways.each(model.Shape)
    def deform_track(self, /, handle_set_id: str, handle_ids: Sequence[str], positions: Any, *,
                     angles: Any = None, scales: Any = None,
                     options: model.ShapeOptions = model.ShapeOptions(),
                     **call: Any) -> Program[None]:
        """An iterator of the Shapes of a track, in order: positions are frames×handles×2, angles and
        scales frames×handles, in the order of handle_ids, which names every handle once. A frame that
        takes longer than ten minutes is DEADLINE_EXCEEDED; ended early, the track is cancelled."""
        frames = _requests.track_frames(handle_ids, positions, angles, scales)
        request = message("DeformTrackRequest")(session_id=self.id, handle_set_id=handle_set_id,
                                                handle_ids=handle_ids)
        for frame in frames:
            request.frames.add(**frame)
        _requests.set_shape_options(request.options, options)
        question = _shapes.Question(options, self._sizes.of_set(handle_set_id))
        return _programs.track(request, len(frames), question, CallOptions(**call))
