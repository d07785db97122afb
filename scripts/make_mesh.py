#!/usr/bin/python3
"""Writes the mesh of an obstacle as an OBJ file.

  scripts/make_mesh.py flap config/scenes/flap.obj      # of the scene folding_board
  scripts/make_mesh.py hills /tmp/hills.obj --cells 158   # 2 * cells^2 triangles, to measure cost
"""
import argparse
import math


def grid(columns, rows, place, keep=lambda i, j: True):
    """Returns the vertices and triangles of a grid, without the cells that `keep` refuses."""
    vertices = [place(i / columns, j / rows) for j in range(rows + 1) for i in range(columns + 1)]
    triangles = []
    for j in range(rows):
        for i in range(columns):
            if not keep(i, j):
                continue
            a = j * (columns + 1) + i
            c = a + columns + 1
            triangles += [(a, a + 1, c), (a + 1, c + 1, c)]
    return vertices, triangles


def flap():
    """A flap of a folding board, 0.24 m x 0.36 m, hinged on the y axis, with two openings."""
    def keep(i, j):
        return not (2 <= i < 10 and (2 <= j < 8 or 10 <= j < 16))
    return grid(12, 18, lambda u, v: (0.24 * u, 0.36 * (v - 0.5), 0.0), keep)


def hills(cells):
    """Gentle hills, 1.26 m x 1.26 m."""
    def place(u, v):
        x, y = 1.26 * (u - 0.5), 1.26 * (v - 0.5)
        return x, y, 0.01 * math.sin(9 * x) * math.cos(7 * y)
    return grid(cells, cells, place)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('mesh', choices=('flap', 'hills'))
    parser.add_argument('file')
    parser.add_argument('--cells', type=int, default=158, help='of hills, along each side')
    options = parser.parse_args()
    vertices, triangles = flap() if options.mesh == 'flap' else hills(options.cells)
    used = sorted({v for triangle in triangles for v in triangle})
    number = {v: k + 1 for k, v in enumerate(used)}
    with open(options.file, 'w', encoding='ascii') as file:
        file.write(f'# scripts/make_mesh.py {options.mesh}\n')
        for v in used:
            file.write('v {:.6g} {:.6g} {:.6g}\n'.format(*vertices[v]))
        for triangle in triangles:
            file.write('f {} {} {}\n'.format(*(number[v] for v in triangle)))


if __name__ == '__main__':
    main()
