"""Tables for terminals and for Markdown."""


def percentile(values, share):
    """Nearest rank."""
    ordered = sorted(values)
    return ordered[max(0, -(-len(ordered) * share // 100) - 1)]


def milliseconds(ns):
    ms = ns / 1e6
    return '%.2f' % ms if ms < 10 else '%.0f' % ms


def p50_max(times):
    return '%s / %s' % (milliseconds(percentile(times, 50)), milliseconds(max(times))) if times else '-'


def text_table(head, rows):
    widths = [max(len(str(row[i])) for row in [head] + rows) for i in range(len(head))]
    return '\n'.join('  '.join(str(cell).ljust(width) for cell, width in zip(row, widths)).rstrip()
                     for row in [head] + rows)


def markdown_table(head, rows):
    return '\n'.join('| ' + ' | '.join(str(cell) for cell in row) + ' |' for row in
                     [head, ['---'] * len(head)] + rows)
