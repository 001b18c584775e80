"""Fold-back of a foreign node, as the tables of docs/protocol.md have it: protocol.md sections 8.7 to 8.11. It sends its
DATPs only as a whole, so its output half has no use for the state `leaving`."""

from foreign_links import ABORT, END, FOLD, IDLE, MORE, START, INTERRUPT, slice_of

BEGIN, LAST, LOST, DEAF, HEARS = 1, 2, 3, 4, 5
FIRST, SECOND, DRAINING = 'first', 'second', 'draining'
UP, SILENT, FOLDED = 1, 2, 3  # link states of a beacon
PERIOD, PERMISSION, DRAIN = 0.1, 0.2, 0.05


class NoFold:
    """A ring without a second line."""

    def __init__(self, node, line):
        self.line = line
        line.on_slice, line.gap = node.take_slice, node.break_off

    def poll(self, now):
        pass

    def cut_off(self, source):
        return False

    def closed(self):
        return self.line.input.up() and self.line.output.up()

    def link_states(self):
        return self.line.input.up(), self.line.output.up()

    def write(self, framed):
        self.line.output.write(framed)


class Fold:
    def __init__(self, node, first, second):
        self.node, self.id, self.first, self.second = node, node.id, first, second
        first.on_slice, first.gap = self.on_first, lambda: self.input == FIRST and node.break_off()
        second.on_slice, second.gap = self.on_second, self.break_off_second
        self.input, self.output, self.fold_node = SECOND, FIRST, None
        self.may_fold = self.next_is_deaf = self.spoken = self.second_open = self.repeated_open = False
        self.held, self.repeated = [], 0
        self.was_up = [False] * 4
        self.now, self.permission, self.say_due, self.drain_due, self.heard_due = 0, None, None, None, None

    # ---- what the node asks -----------------------------------------------------------------

    def input_up(self):
        return self.first.input.up() if self.input == FIRST else self.fold_node is not None

    def output_up(self):
        return self.first.output.up() if self.output == FIRST else self.second.output.up() and self.input_up()

    def closed(self):
        return self.input_up() and self.output_up()

    def link_states(self):
        inward = FOLDED if self.input != FIRST and self.fold_node is not None else UP if self.input_up() else SILENT
        outward = FOLDED if self.output != FIRST and self.output_up() else UP if self.output_up() else SILENT
        return inward, outward

    def write(self, framed):
        (self.first if self.output == FIRST else self.second).output.write(framed)

    # ---- lines come and go ------------------------------------------------------------------

    def poll(self, now):
        self.now = now
        self.permission = self.permission or now + PERMISSION
        is_up = [self.first.input.up(), self.first.output.up(), self.second.input.up(), self.second.output.up()]
        changed = [new - old for old, new in zip(self.was_up, is_up)]
        self.was_up = is_up
        if (is_up[0] and is_up[1]) or now >= self.permission:
            if not self.may_fold:
                self.may_fold = True
                self.say_again()
        if changed[0] > 0:
            self.first_input_up()
        if changed[0] < 0:
            self.first_input_lost()
        if changed[1] > 0:
            self.next_is_deaf = False
            self.greet()
        if changed[2] < 0:
            self.lose_fold_node()
        if changed[3] > 0:
            self.repeated_open = False
            if self.repeats():
                self.say(BEGIN, self.fold_node)
            self.say_again()
        self.choose_output()
        if not self.repeats():
            self.stop_repeating()
        self.timers()

    def timers(self):
        if self.say_due and self.now >= self.say_due:
            self.say_again()
        if self.drain_due and self.now >= self.drain_due:
            self.take_first()
        if self.heard_due and self.now >= self.heard_due:
            self.lose_fold_node()

    # ---- the input half ---------------------------------------------------------------------

    def first_input_up(self):
        self.spoken = False
        if self.may_fold:
            self.say(HEARS, self.id)
        self.input = DRAINING
        distance = self.first.distance
        if self.fold_node is not None and distance(self.fold_node) < distance(self.first.sender):
            self.forget_fold_node()
        elif self.fold_node is None:
            self.take_first()

    def first_input_lost(self):
        self.held.clear()
        if self.input == FIRST:
            self.node.break_off()
        self.input, self.drain_due = SECOND, None
        self.say_again()

    def on_first(self, kind, data):
        if kind == IDLE:
            return
        if self.input == FIRST:
            if kind != FOLD:
                self.node.take_slice(kind, data)
            return
        self.spoken = True
        if kind != FOLD:
            self.held.append((kind, data))
        self.drain()

    def drain(self):
        if self.input != DRAINING or not self.spoken:
            return
        if self.fold_node != self.first.sender and not self.second_open:
            self.take_first()
        elif not self.drain_due:
            self.drain_due = self.now + DRAIN

    def take_first(self):
        self.input, self.drain_due = FIRST, None
        if self.second_open:
            self.node.break_off()
        self.second_open = False
        if self.fold_node == self.first.sender:
            self.fold_node = self.heard_due = None
        if self.fold_node is not None:
            self.say(BEGIN, self.fold_node)
        held, self.held = self.held, []
        for kind, data in held:
            self.node.take_slice(kind, data)

    # ---- the output half --------------------------------------------------------------------

    def choose_output(self):
        back = (not self.first.output.up() and self.may_fold) or self.next_is_deaf
        if back and self.output == FIRST:
            self.output = SECOND
            self.say_again()
        elif not back and self.output == SECOND:
            self.output = FIRST
            self.say(LAST, self.id)
            self.greet()
            if self.fold_node is not None and self.input == FIRST:
                self.say(BEGIN, self.fold_node)

    def greet(self):
        if self.output == FIRST:
            self.first.output.write(self.word(LAST, self.id))

    # ---- the second line --------------------------------------------------------------------

    @staticmethod
    def word(kind, node):
        return slice_of(FOLD, bytes([kind, node, 0xFF ^ kind ^ node]))

    def stop_repeating(self):
        if self.repeated_open:
            self.second.output.write(slice_of(ABORT))
        self.repeated_open = False

    def say(self, kind, node):
        if kind not in (DEAF, HEARS):
            self.stop_repeating()
        self.second.output.write(self.word(kind, node))

    def say_again(self):
        self.say_due = None
        if not self.may_fold:
            return
        if self.input != FIRST:
            self.say(DEAF if self.input == SECOND else HEARS, self.id)
        if self.output != FIRST:
            self.say(BEGIN, self.id)
        if (self.input, self.output) != (FIRST, FIRST):
            self.say_due = self.now + PERIOD

    def repeats(self):
        return self.input == FIRST and self.output == FIRST and self.fold_node is not None

    def on_second(self, kind, data):
        if kind == FOLD:
            return self.hear(data)
        if kind == IDLE or self.fold_node is None or (self.input == FIRST and not self.may_repeat(kind, data)):
            return
        self.second_open = kind == START or (self.second_open and kind in (MORE, INTERRUPT))
        if self.input == FIRST:
            self.repeated += 1
            self.repeated_open = kind == START or (self.repeated_open and kind in (MORE, INTERRUPT))
            return self.second.output.write(slice_of(kind, data))
        self.node.take_slice(kind, data)
        self.drain()

    def may_repeat(self, kind, data):
        if kind in (MORE, END, ABORT):
            return self.repeats() and self.repeated_open
        return self.repeats() and not (data[3] == self.id and data[2] == 0)  # else it has come straight from here

    def break_off_second(self):
        if self.second_open and self.input != FIRST:
            self.node.break_off()
        self.stop_repeating()
        self.second_open = False

    def hear(self, data):
        kind, node, check = data
        if check != 0xFF ^ kind ^ node or not BEGIN <= kind <= HEARS or node not in self.first.order:
            return
        if kind in (DEAF, HEARS):
            if node == self.first.successor:
                self.next_is_deaf = kind == DEAF
                if kind == HEARS:
                    self.greet()
                self.choose_output()
            return
        if node != self.id and self.ahead(node) >= self.ahead(self.second.sender):
            return self.hear_of_fold_node(kind, node)
        # It has come all the way round, and so has what follows a `begin`.
        if (kind == BEGIN or (kind == LOST and node == self.id)) and self.fold_node is not None:
            self.lose_fold_node()

    def ahead(self, node):
        order = self.first.order
        return (order.index(node) - order.index(self.id)) % len(order)

    def cut_off(self, source):
        """Between the fold node and this node, while the second line is the input. (protocol.md section 4.9)"""
        return (self.input != FIRST and self.fold_node is not None and source in self.first.order and
                self.ahead(source) > self.ahead(self.fold_node))

    def hear_of_fold_node(self, kind, node):
        if kind == BEGIN and node == self.first.sender and self.input == FIRST:
            self.say(HEARS, self.id)
        if kind == BEGIN and node == self.fold_node and self.heard_due - self.now > 4.5 * PERIOD:
            return
        if self.input == FIRST and self.output == FIRST:
            self.say(kind, node)
        if kind == BEGIN:
            self.fold_node, self.heard_due = node, self.now + 5 * PERIOD
        elif kind == LOST or node == self.fold_node:
            self.break_off_second()
            self.forget_fold_node()

    def lose_fold_node(self):
        self.break_off_second()
        if self.repeats():
            self.say(LOST, self.id)
        self.forget_fold_node()

    def forget_fold_node(self):
        self.fold_node = self.heard_due = None
        if self.input == DRAINING:
            self.take_first()
