#!/usr/bin/env python3
"""Measures the drawings of arapctl by programs that are not ours, to 0.05 mm.

Usage: true_size.py ARAPCTL. Ends with 77 (skipped) where rsvg-convert, pdftoppm, pdftotext or
ezdxf is missing.
"""
import math
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from xml.etree import ElementTree

DPI = 1016  # a pixel is 0.025 mm
TOLERANCE = 0.05
WIDTH, HEIGHT = 93.25, 41.5  # of the part when it is flat
COLUMNS, ROWS = 12, 5
NAME = "Ärmel & <50%>"


def millimetres(pixels):
    return pixels * 25.4 / DPI


def pixels(length):
    return length * DPI / 25.4


def write_part(path):
    """A sheet bent into an arch along straight rulings, in centimetres: flat it is a rectangle."""
    step = 0.25  # radians between rulings
    radius = WIDTH / COLUMNS / (2 * math.sin(step / 2))
    lines = ["o " + NAME]
    for row in range(ROWS + 1):
        for column in range(COLUMNS + 1):
            angle = step * column
            point = (radius * math.cos(angle), HEIGHT * row / ROWS, -radius * math.sin(angle))
            lines.append("v " + " ".join(repr(x / 10) for x in point))
    for row in range(ROWS):
        for column in range(COLUMNS):
            a = row * (COLUMNS + 1) + column + 1
            b = a + COLUMNS + 1
            lines += [f"f {a} {a + 1} {b + 1}", f"f {a} {b + 1} {b}"]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


class Picture:
    """A page as pdftoppm sees it: rows of grey."""

    def __init__(self, pdf, page=1):
        data = subprocess.run(
            ["pdftoppm", "-r", str(DPI), "-gray", "-f", str(page), "-l", str(page), str(pdf)],
            check=True, capture_output=True).stdout
        kind, size, _, self.pixels = data.split(b"\n", 3)
        assert kind == b"P5", kind
        self.width, self.height = map(int, size.split())

    def dark(self, row=None, column=None):
        """The middles of the dark runs along a row or column, in millimetres from the top left."""
        if row is not None:
            line = self.pixels[row * self.width:(row + 1) * self.width]
        else:
            line = self.pixels[column::self.width]
        runs, start = [], None
        for i, grey in enumerate(line + b"\xff"):
            if grey < 128 and start is None:
                start = i
            elif grey >= 128 and start is not None:
                runs.append(millimetres((start + i) / 2))
                start = None
        return runs


def check(what, measured, wanted):
    print(f"{what}: {measured:.3f} mm, wanted {wanted:.3f}")
    assert abs(measured - wanted) <= TOLERANCE, what


def check_rectangle(what, picture):
    # Off the middle, where no dash or mark lies.
    across = picture.dark(row=round(picture.height * 0.4))
    down = picture.dark(column=round(picture.width * 0.4))
    check(what + " across", across[-1] - across[0], WIDTH)
    check(what + " down", down[-1] - down[0], HEIGHT)


def check_dxf(path):
    import ezdxf
    from ezdxf import bbox, units
    drawing = ezdxf.readfile(path)
    audit = drawing.audit()
    assert not audit.errors and not audit.fixes, [e.message for e in audit.errors + audit.fixes]
    assert drawing.units == units.MM and drawing.header["$MEASUREMENT"] == 1
    names = [ezdxf.decode_dxf_unicode(text.plain_text()) for text in drawing.modelspace().query("TEXT")]
    assert names == [NAME], names
    size = bbox.extents(drawing.modelspace().query("LWPOLYLINE")).size
    check("DXF across", size.x, WIDTH)
    check("DXF down", size.y, HEIGHT)


def check_names(svg, pdf):
    texts = [text.text for text in ElementTree.parse(svg).iter("{http://www.w3.org/2000/svg}text")]
    assert NAME in texts, texts
    text = subprocess.run(["pdftotext", str(pdf), "-"], check=True, capture_output=True).stdout
    assert NAME in text.decode(), text


def check_pages(pdf):
    """Two pages of 100 x 100 mm, joined at their marks."""
    cover, left, right = (Picture(pdf, page) for page in (1, 2, 3))
    square = cover.dark(row=round(cover.height * 0.35))
    check("test square", square[1] - square[0], 50)
    # On the row of the upper marks, which are crossed by a line along it: the left page has a side of
    # the part and then the mark, the right one the mark and then the other side.
    row = round(pixels(10 + 0.25 * 80))
    a, b = left.dark(row=row), right.dark(row=row)
    print("mark of the left page at", a[-1], "of the right page at", b[0])
    check("joined pages", (b[-1] - b[0]) + (a[-1] - a[0]), WIDTH)


def main():
    try:
        import ezdxf  # noqa: F401
    except ImportError:
        sys.exit(77)
    if not all(map(shutil.which, ("rsvg-convert", "pdftoppm", "pdftotext"))):
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        at = Path(folder)
        write_part(at / "part.obj")

        def draw(*words):
            subprocess.run([sys.argv[1], "flatten", at / "part.obj", "--spawn", "--unit", "cm", *words],
                           check=True)

        draw("--plain", "--svg", at / "part.svg", "--dxf", at / "part.dxf", "--pdf", at / "part.pdf")
        subprocess.run(["rsvg-convert", "-f", "pdf", "-o", at / "svg.pdf", at / "part.svg"], check=True)
        check_rectangle("SVG", Picture(at / "svg.pdf"))
        check_rectangle("PDF", Picture(at / "part.pdf"))
        draw("--svg", at / "coloured.svg", "--pdf", at / "coloured.pdf")
        check_names(at / "coloured.svg", at / "coloured.pdf")
        check_dxf(at / "part.dxf")
        draw("--paper", "100x100", "--pdf", at / "pages.pdf", "--svg", at / "page.svg")
        check_pages(at / "pages.pdf")
        first = (at / "pages.pdf").read_bytes()
        draw("--paper", "100x100", "--pdf", at / "pages.pdf")
        assert (at / "pages.pdf").read_bytes() == first, "the same part, other bytes"
        for page in ("cover", "1", "2"):
            subprocess.run(["rsvg-convert", "-f", "pdf", "-o", at / f"{page}.pdf",
                            at / f"page-{page}.svg"], check=True)
        square = Picture(at / "cover.pdf").dark(row=round(Picture(at / "cover.pdf").height * 0.35))
        check("test square of the SVG", square[1] - square[0], 50)


if __name__ == "__main__":
    main()
