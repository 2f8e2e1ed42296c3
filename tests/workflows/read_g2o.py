#!/usr/bin/python3
"""Reads a pose graph after g2o's own definitions (VERTEX_SE3:QUAT, EDGE_SE3:QUAT: the pose of j in i)
and prints as JSON how many vertices and edges it has, how many groups they make, and by how much an
edge is off its vertices at most, in metres and in its sigmas along an axis. Ends with 1 for what is no
such file.

usage: read_g2o.py FILE
"""
import json
import sys

import numpy as np
from scipy.spatial.transform import Rotation


def pose(words):
    values = np.array(words, dtype=float)
    return Rotation.from_quat(values[3:7]), values[:3]


def main():
    vertices, edges = {}, []
    for line in open(sys.argv[1]):
        words = line.split()
        if words[0] == 'VERTEX_SE3:QUAT' and len(words) == 9:
            vertices[int(words[1])] = pose(words[2:])
        elif words[0] == 'EDGE_SE3:QUAT' and len(words) == 10 + 21:
            information = np.zeros((6, 6))
            information[np.triu_indices(6)] = np.array(words[10:], dtype=float)
            information = information + np.triu(information, 1).T
            if np.linalg.eigvalsh(information).min() <= 0:
                sys.exit(f'read_g2o: expected information of full rank, found {line}')
            sigmas = np.sqrt(np.diag(np.linalg.inv(information))[:3])
            edges.append((int(words[1]), int(words[2]), pose(words[3:10]), sigmas))
        elif words[0] != 'FIX':
            sys.exit(f'read_g2o: expected a vertex or an edge, found {line}')
    group = {vertex: vertex for vertex in vertices}

    def root(vertex):
        while group[vertex] != vertex:
            vertex = group[vertex]
        return vertex

    worst_m = worst_sigmas = 0.0
    for i, j, (_, shift), sigmas in edges:
        (turn_i, at_i), (_, at_j) = vertices[i], vertices[j]
        off = turn_i.inv().apply(at_j - at_i) - shift
        worst_m = max(worst_m, float(np.linalg.norm(off)))
        worst_sigmas = max(worst_sigmas, float(np.max(np.abs(off) / sigmas)))
        group[root(i)] = root(j)
    print(json.dumps({'vertices': len(vertices), 'edges': len(edges),
                      'groups': len({root(vertex) for vertex in vertices}), 'worst_m': worst_m,
                      'worst_sigmas': worst_sigmas}))


main()
