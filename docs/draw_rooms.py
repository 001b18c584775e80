#!/usr/bin/env python3
"""Draws docs/rooms.svg: the rooms of daemon/ and what stands around them, and who sees whom, read from the #include lines.

A room's sentence is the first of its CMakeLists.txt. `--check` writes nothing and fails where the picture is another."""
import pathlib
import re
import sys

SOURCES = pathlib.Path(__file__).resolve().parents[1]
PICTURE = SOURCES / 'docs' / 'rooms.svg'
AROUND = {'ros_bridge': 'ring_bridge and the programs beside it: the ring as ROS sees it.',
          'include': 'The public headers: client library, and formats inside packets.'}
ROW, LEFT, COLUMN, TOP = 34, 112, 24, 10


def rooms():
    """From the top to the ground, as daemon/CMakeLists.txt lists them from there."""
    listed = re.search(r'foreach\(room ([\w ]+)\)', (SOURCES / 'daemon/CMakeLists.txt').read_text(encoding='utf-8'))
    return ['ros_bridge'] + listed.group(1).split()[::-1] + ['include']


def folder(room):
    return SOURCES / room if room in AROUND else SOURCES / 'daemon' / room


def sentence(room):
    if room in AROUND:
        return AROUND[room]
    head = []
    for line in (folder(room) / 'CMakeLists.txt').read_text(encoding='utf-8').split('\n'):
        if not line.startswith('#'):
            break
        head.append(line[1:].strip())
    words = re.match(r'%s: (.*?\.)( |$)' % room, ' '.join(head))
    if not words:
        sys.exit("draw_rooms: daemon/%s/CMakeLists.txt has to begin with '# %s: ' and one sentence" % (room, room))
    return words.group(1)


def seen_by(room, known):
    """The rooms whose headers a room includes."""
    seen = set()
    for path in sorted(folder(room).rglob('*')):
        if path.suffix in ('.h', '.cpp'):
            for name in re.findall(r'^#include "(\w+)/', path.read_text(encoding='utf-8'), re.M):
                seen.add('include' if name == 'limb_ring' else name)
    return seen & known - {room}


def picture():
    listed = rooms()
    height = TOP + ROW * len(listed) + 30
    out = ['<svg xmlns="http://www.w3.org/2000/svg" width="1010" height="%d" font-family="sans-serif" font-size="12">' % height,
           '<rect width="100%" height="100%" fill="white"/>']
    arrows = 0
    right = LEFT + COLUMN * len(listed) + 16
    for row, room in enumerate(listed):
        y = TOP + ROW * row
        colour = '#e8e8e8' if room in AROUND else '#d6e6f5'
        out.append('<rect x="8" y="%d" width="994" height="%d" fill="%s"/>' % (y, ROW - 6, '#fafafa'))
        out.append('<rect x="8" y="%d" width="92" height="%d" rx="4" fill="%s" stroke="#557"/>' % (y, ROW - 6, colour))
        out.append('<text x="54" y="%d" text-anchor="middle" font-weight="bold">%s</text>' % (y + 18, room))
        out.append('<text x="%d" y="%d">%s</text>' % (right, y + 18, sentence(room).replace('&', '&amp;').replace('<', '&lt;')))
    for column, room in enumerate(listed):
        seen = seen_by(room, set(listed))
        up = [other for other in seen if listed.index(other) < column]
        if up:
            sys.exit('draw_rooms: %s sees %s, which is above it' % (room, ', '.join(sorted(up))))
        x, y = LEFT + COLUMN * column, TOP + ROW * column + 14
        lowest = max((listed.index(other) for other in seen), default=column)
        out.append('<circle cx="%d" cy="%d" r="5" fill="none" stroke="#557"/>' % (x, y))
        if lowest > column:
            out.append('<path d="M%d %dV%d" stroke="#557"/>' % (x, y + 5, TOP + ROW * lowest + 14))
        for other in sorted(seen, key=listed.index):
            arrows += room not in AROUND and other not in AROUND
            out.append('<circle cx="%d" cy="%d" r="4" fill="#c33"/>' % (x, TOP + ROW * listed.index(other) + 14))
    out.append('<text x="8" y="%d">A line goes down from each room; a dot lies where it includes headers of that row\'s room: '
               '%d arrows between the %d rooms of daemon/.</text>' % (height - 12, arrows, len(listed) - len(AROUND)))
    return '\n'.join(out) + '\n</svg>\n'


def main():
    drawn = picture()
    if sys.argv[1:] != ['--check']:
        PICTURE.write_text(drawn, encoding='utf-8')
    elif not PICTURE.exists() or PICTURE.read_text(encoding='utf-8') != drawn:
        sys.exit('docs/rooms.svg is not what the includes say: run docs/draw_rooms.py')


if __name__ == '__main__':
    main()
