#!/usr/bin/python3
"""Reads a LAS 1.4 file after its specification (ASPRS, LAS 1.4 R15), field by field, and prints what
it holds as JSON; ends with 1 where the file contradicts itself or the specification.

usage: read_las.py FILE
"""
import json
import struct
import sys

HEADER = struct.Struct('<4sHHIHH8sBB32s32sHHHIIBHI5I12dQQIQ15Q')
VLR = struct.Struct('<H16sHH32s')
FORMAT_2 = struct.Struct('<3iHBBbBH3H')
TYPES = {1: 'B', 2: 'b', 3: 'H', 4: 'h', 5: 'I', 6: 'i', 7: 'Q', 8: 'q', 9: 'f', 10: 'd'}


def require(holds, text):
    if not holds:
        sys.exit(f'read_las: {text}')


def name(field):
    return field.split(b'\0')[0].decode('ascii')


def main(path):
    data = open(path, 'rb').read()
    require(HEADER.size == 375, f'the header has {HEADER.size} bytes')
    h = HEADER.unpack_from(data)
    (signature, source, encoding, _, _, _, _, major, minor, system, software, day, year, header_size,
     first_point, vlr_count, point_format, record_size, legacy_count) = h[:19]
    legacy_returns, geometry = h[19:24], h[24:36]
    evlr_start, waveform, evlr_count, count, returns = h[37], h[36], h[38], h[39], h[40:55]
    require(signature == b'LASF' and (major, minor) == (1, 4), 'no LAS 1.4')
    require(header_size == 375 and point_format == 2 and record_size >= 26, 'header or format')
    require((waveform, evlr_start, evlr_count) == (0, 0, 0), 'waveforms or extended records')
    require(legacy_count == count and sum(legacy_returns) == count == sum(returns), 'counts')
    scale, offset = geometry[0:3], geometry[3:6]
    high, low = geometry[6:12:2], geometry[7:12:2]

    at, records = header_size, []
    extra = []
    for _ in range(vlr_count):
        reserved, user, number, length, about = VLR.unpack_from(data, at)
        content = data[at + VLR.size:at + VLR.size + length]
        at += VLR.size + length
        record = {'user': name(user), 'id': number, 'about': name(about), 'length': length}
        if (name(user), number) == ('LASF_Projection', 34735):
            words = struct.unpack(f'<{length // 2}H', content)
            require(words[0] == 1 and len(words) == 4 + 4 * words[3], 'GeoTIFF keys')
            keys = [words[i:i + 4] for i in range(4, len(words), 4)]
            require([k[0] for k in keys] == sorted(k[0] for k in keys), 'keys out of order')
            record['keys'] = {str(k[0]): k[3] for k in keys}
        if (name(user), number) == ('LASF_Spec', 4):
            require(length % 192 == 0, 'extra bytes')
            for i in range(0, length, 192):
                kind, options = content[i + 2], content[i + 3]
                extra.append((name(content[i + 4:i + 36]), TYPES[kind]))
        if (name(user), number) == ('LASF_Spec', 3):
            record['text'] = name(content)
        records.append(record)
    require(at == first_point, f'points begin at {first_point}, records end at {at}')
    tail = struct.Struct('<' + ''.join(code for _, code in extra))
    require(record_size == FORMAT_2.size + tail.size, 'record size')
    require(len(data) == first_point + count * record_size, 'length of the file')

    points = []
    for i in range(count):
        begin = first_point + i * record_size
        x, y, z, intensity, bits, kind, angle, user, point_source, r, g, b = FORMAT_2.unpack_from(
            data, begin)
        require(bits == 0b001001, 'return 1 of 1')
        place = [s * c + o for s, c, o in zip(scale, (x, y, z), offset)]
        for c, l, u in zip(place, low, high):
            require(l - 1e-9 <= c <= u + 1e-9, f'{place} outside {low} {high}')
        more = tail.unpack_from(data, begin + FORMAT_2.size)
        points.append({'xyz': place, 'rgb': [r, g, b]} | dict(zip((n for n, _ in extra), more)))
    print(json.dumps({'encoding': encoding, 'day': day, 'year': year, 'system': name(system),
                      'software': name(software), 'scale': scale, 'offset': offset, 'low': low,
                      'high': high, 'records': records, 'count': count, 'points': points[:1000]}))


main(sys.argv[1])
