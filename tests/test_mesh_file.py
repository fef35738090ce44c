"""The door for scans: good files in every format and unit, and a table of bad ones."""

import json
import struct
from pathlib import Path

import numpy as np
import pytest
import trimesh

from garmentcad.errors import FileError, MeshError
from garmentcad.geometry import repair
from garmentcad.io import mesh_file
from garmentcad.io.mesh_file import read_mesh


def egg(height=1.7):
    mesh = trimesh.creation.icosphere(subdivisions=3)
    mesh.apply_scale([0.3 * height / 2, height / 2, 0.2 * height / 2])
    return mesh


@pytest.mark.parametrize("ending", ["obj", "ply", "stl", "glb"])
def test_every_format_gives_the_same_closed_surface(tmp_path, ending):
    path = tmp_path / f"body.{ending}"
    egg().export(path)
    vertices, faces, repairs = read_mesh(path)
    assert repairs == ()
    assert vertices.dtype == np.float64
    assert faces.dtype == np.int32
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(egg().volume, rel=1e-5)
    assert len(vertices) == len(egg().vertices)


def test_names_in_an_obj_may_be_in_any_encoding(tmp_path):
    path = tmp_path / "body.obj"
    egg().export(path)
    expected = read_mesh(path)[0]
    path.write_bytes("o Körper\n".encode("latin-1") + path.read_bytes())
    assert (read_mesh(path)[0] == expected).all()


@pytest.mark.parametrize(("factor", "unit"), [(1, None), (100, None), (1000, None), (1 / 0.0254, "inch"), (10, "dm")])
def test_units_are_found_or_given(tmp_path, factor, unit):
    path = tmp_path / "body.obj"
    mesh = egg()
    mesh.apply_scale(factor)
    mesh.export(path)
    assert np.ptp(read_mesh(path, unit)[0][:, 1]) == pytest.approx(1.7, rel=1e-6)


def test_a_scan_in_inches_is_not_taken_for_a_dwarf_in_silence(tmp_path):
    path = tmp_path / "body.obj"
    egg(1.7 / 0.0254).export(path)
    vertices, _, said = read_mesh(path)
    assert np.ptp(vertices[:, 1]) == pytest.approx(0.669, abs=1e-3)
    assert len(said) == 1
    assert "66.93 was read as 669 mm of height" in said[0]
    assert "`unit: inch`" in said[0]
    assert read_mesh(path, unit="cm")[2] == read_mesh(path, unit="inch")[2] == ()


@pytest.mark.parametrize(("axes", "said"), [([0, 2, 1], "along z it is as long as a body: turn the scan upright"), ([0, 1, 2], "`unit: inch`")])
def test_what_no_unit_makes_a_body_is_refused_with_what_helps(tmp_path, axes, said):
    mesh = egg(1.7 if axes[1] == 2 else 17.0)
    mesh.vertices = np.asarray(mesh.vertices)[:, axes]
    mesh.export(tmp_path / "body.obj")
    with pytest.raises(MeshError) as fault:
        read_mesh(tmp_path / "body.obj")
    assert said in fault.value.message


def test_inside_out_surface_is_turned(tmp_path):
    path = tmp_path / "body.ply"
    mesh = egg()
    mesh.invert()
    mesh.export(path)
    assert trimesh.Trimesh(*read_mesh(path)[:2], process=False).volume > 0


def obj(vertices, faces):
    lines = [f"v {x} {y} {z}" for x, y, z in vertices] + ["f " + " ".join(str(k + 1) for k in face) for face in faces]
    return "\n".join(lines).encode()


def bad_nan():
    text = obj(egg().vertices, egg().faces).split(b"\n")
    text[5] = b"v nan 0 0"
    return b"\n".join(text)


def bad_stl_count():
    raw = bytearray(egg().export(file_type="stl"))
    struct.pack_into("<I", raw, 80, 4_000_000_000)
    return bytes(raw)


def bad_short_count():
    raw = bytearray(egg().export(file_type="stl"))
    struct.pack_into("<I", raw, 80, 3)
    return bytes(raw)


def bad_open():
    mesh = egg()
    return obj(mesh.vertices, mesh.faces[mesh.triangles_center[:, 1] > -0.6])  # no legs: 25 % of the surface


def bad_two():
    one, two = egg(), egg()
    two.apply_translation([2, 0, 0])
    both = trimesh.util.concatenate([one, two])
    return obj(both.vertices, both.faces)


def bad_moebius():
    turn, across = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False), [-0.2, 0.2], indexing="ij")
    radius = 0.8 + across * np.cos(0.5 * turn)
    points = np.stack([radius * np.cos(turn), radius * np.sin(turn), across * np.sin(0.5 * turn)], axis=-1).reshape(-1, 3)
    faces = []
    for k in range(60):
        a, b, c, d = 2 * k, 2 * k + 1, (2 * k + 2) % 120, (2 * k + 3) % 120
        c, d = (d, c) if k == 59 else (c, d)
        faces += [[a, c, b], [b, c, d]]
    return obj(points, faces)


def bad_fin():
    mesh = egg()
    tip = len(mesh.vertices)
    a, b = mesh.faces[0][:2]
    return obj([*mesh.vertices, [3, 3, 3], [4, 4, 4]], [*mesh.faces, [a, b, tip], [b, a, tip + 1], [a, b, tip + 1], [b, a, tip]])


def glb(head):
    text = json.dumps({"asset": {"version": "2.0"}, **head}).encode()
    text += b" " * (-len(text) % 4)
    return struct.pack("<4sII", b"glTF", 2, 20 + len(text)) + struct.pack("<I4s", len(text), b"JSON") + text


BAD = {
    "empty.obj": (lambda: b"", "empty"),
    "empty.stl": (lambda: b"", "empty"),
    "words.obj": (lambda: b"this is not a mesh\n", "no triangles|not a readable|0 faces"),
    "zeros.glb": (lambda: glb({"accessors": [{"componentType": 5126, "type": "VEC3", "count": 10**8}]}), "100000000 elements has no bufferView"),
    "claims.glb": (lambda: glb({"accessors": [{"count": 10**8, "bufferView": 0}]}), "claim 100000000 elements"),
    "copies.glb": (lambda: glb({"meshes": [{}], "nodes": [{"mesh": 0}] * 9}), "1 meshes stand in 9 places"),
    "odd.glb": (lambda: glb({"accessors": 3}), "not a readable GLB"),
    "noise.glb": (lambda: bytes(range(256)) * 4, "not a readable"),
    "noise.ply": (lambda: bytes(range(256)) * 4, "not a readable"),
    "noise.stl": (lambda: bytes(range(256)) * 4, "claims"),
    "short.stl": (lambda: b"abc", "too few"),
    "nan.obj": (bad_nan, "not finite"),
    "lies.stl": (bad_stl_count, "claims 4000000000 triangles"),
    "hides.stl": (bad_short_count, "claims 3 triangles"),
    "lies.ply": (lambda: b"ply\nformat ascii 1.0\nelement vertex 999999999\nproperty float x\nend_header\n0\n", "claims 999999999"),
    "open.obj": (bad_open, "not closed"),
    "moebius.obj": (bad_moebius, "not closed|not turned alike"),
    "two.obj": (bad_two, "2 separate"),
    "fin.obj": (bad_fin, "more than two faces|not closed"),
    "index.obj": (lambda: obj(egg().vertices[:50], egg().faces), "vertex|not a readable"),
    "tiny.obj": (lambda: obj(egg(0.004).vertices, egg(0.004).faces), "0.5 to 2.5 m"),
    "giant.obj": (lambda: obj(egg(9000).vertices, egg(9000).faces), "0.5 to 2.5 m"),
    "few.obj": (lambda: obj([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]), "4 faces"),
    "body.fbx": (lambda: b"x", "ending"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_meshes_are_refused_with_the_reason(tmp_path, name):
    content, reason = BAD[name]
    path = tmp_path / name
    path.write_bytes(content())
    with pytest.raises(MeshError, match=reason) as caught:
        read_mesh(path)
    assert caught.value.file == str(path)


def test_too_many_faces_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(mesh_file, "MAX_FACES", 200)
    path = tmp_path / "body.ply"
    egg().export(path)
    with pytest.raises(MeshError, match="at most 200"):
        read_mesh(path)


def test_cut_off_files_never_leak_foreign_errors(tmp_path):
    """Refused; or, where all that the end held was a few faces, repaired, and it is said."""
    for ending in ("obj", "ply", "stl", "glb"):
        raw = egg().export(file_type=ending)
        raw = raw.encode() if isinstance(raw, str) else raw
        for share in (0.05, 0.3, 0.6, 0.9, 0.999):
            path = tmp_path / f"cut.{ending}"
            path.write_bytes(raw[: int(len(raw) * share)])
            try:
                _, _, repairs = read_mesh(path)
            except MeshError:
                continue
            assert share == 0.999
            assert "hole" in repairs[0]


def scan(change):
    """The egg after a change of its vertices and faces, as the bytes of a file."""
    mesh = egg()
    return obj(*change(np.asarray(mesh.vertices), np.asarray(mesh.faces)))


def with_holes(vertices, faces):
    middle = vertices[faces].mean(axis=1)
    return vertices, faces[(middle[:, 1] < 0.83) & (middle[:, 1] > -0.83)]  # the crown and the soles


def with_turned_faces(vertices, faces):
    chosen = np.random.default_rng(3).random(len(faces)) < 0.3
    return vertices, np.where(chosen[:, None], faces[:, ::-1], faces)


def with_a_stray(vertices, faces):
    crumb = trimesh.creation.icosahedron()
    return np.vstack([vertices, 0.01 * crumb.vertices + 2.0]), np.vstack([faces, crumb.faces + len(vertices)])


def with_doubles(vertices, faces):
    return vertices, np.vstack([faces, faces[:4], faces[9:11, ::-1]])


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (with_holes, ["a hole of", "a hole of"]),
        (with_turned_faces, ["faces were turned around"]),
        (with_a_stray, ["1 separate pieces with 20 faces"]),
        (with_doubles, ["6 faces lay on others"]),
    ],
)
def test_scans_are_repaired_and_it_is_said(tmp_path, change, said):
    path = tmp_path / "scan.obj"
    path.write_bytes(scan(change))
    vertices, faces, repairs = read_mesh(path)
    assert len(repairs) == len(said)
    assert all(text in repair for text, repair in zip(said, repairs))
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    # a flat lid takes a little from the crown
    assert mesh.volume == pytest.approx(egg().volume, rel=2e-3 if change is with_holes else 1e-6)


def test_a_repair_that_crosses_the_surface_is_refused(tmp_path):
    """A hole whose middle lies beyond the other side: its lid would run through the body."""
    path = tmp_path / "scan.obj"

    def change(vertices, faces):
        vertices, faces = with_holes(vertices, faces)
        points = vertices.copy()
        rim = np.abs(points[:, 1] - 0.83) < 0.06
        points[rim & (points[:, 0] > 0.0)] -= [0.0, 2.2, 0.0]
        return points, faces

    path.write_bytes(scan(change))
    with pytest.raises(MeshError, match=r"crosses itself|not closed"):
        read_mesh(path)


def test_flipped_bytes_never_leak_foreign_errors(tmp_path):
    random = np.random.default_rng(5)
    for ending in ("obj", "ply", "stl", "glb"):
        raw = egg().export(file_type=ending)
        raw = np.frombuffer(raw.encode() if isinstance(raw, str) else raw, np.uint8)
        path = tmp_path / f"flipped.{ending}"
        for _ in range(25):
            mutated = raw.copy()
            mutated[random.integers(0, min(len(raw), 2000), 6)] = random.integers(0, 256, 6)
            path.write_bytes(mutated.tobytes())
            try:
                vertices, faces, _ = read_mesh(path)
            except MeshError:
                continue
            assert np.isfinite(vertices).all()
            assert len(faces) >= 100


def test_mesh_shrunk_to_a_point_is_refused(tmp_path):
    """Found by the fuzz study: no face was left for the repair to look at."""
    mesh = egg()
    mesh.vertices = mesh.vertices * 0.0
    mesh.export(tmp_path / "point.obj")
    with pytest.raises(MeshError, match="0 faces are left"):
        read_mesh(tmp_path / "point.obj")


def test_missing_file_and_unknown_unit(tmp_path):
    with pytest.raises(FileError, match="no such file"):
        read_mesh(tmp_path / "none.obj")
    with pytest.raises(MeshError, match="unit 'ell'"):
        read_mesh(tmp_path / "none.obj", "ell")


def test_a_mesh_of_thousands_of_pieces_is_refused_in_a_moment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its triangles stand apart by a micrometre: every one has a rim of its own. It took eight minutes for 20,000, and four times as long for twice as many."""
    mesh = egg()
    mesh = mesh.subdivide()
    corners = mesh.triangles.reshape(-1, 3) + np.random.default_rng(0).uniform(-1e-6, 1e-6, (3 * len(mesh.faces), 3))
    path = tmp_path / "soup.ply"
    trimesh.Trimesh(corners, np.arange(len(corners)).reshape(-1, 3), process=False).export(path)
    vertices = []
    areas = repair._areas
    monkeypatch.setattr(repair, "_areas", lambda points, faces: vertices.append(len(points)) or areas(points, faces))
    with pytest.raises(MeshError, match="separate surfaces"):
        read_mesh(path)
    assert len(vertices) > 5000
    assert sum(vertices) < 20 * len(corners), "what is looked at for a hole is its rim"
