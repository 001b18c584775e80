"""The layouts for PlotJuggler and Foxglove name topics that the bridge has, fields of their messages, and nodes and joints of
humanoid16.yaml. Neither program is needed for that, nor ROS."""
import glob
import json
import os
import re
import unittest
import xml.etree.ElementTree

import yaml

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
JOINT_STATE = {'header': 'Header', 'name': 'string[]', 'position': 'float64[]', 'velocity': 'float64[]', 'effort': 'float64[]'}


def read(*names):
    with open(os.path.join(ROOT, *names), encoding='utf-8') as file:
        return file.read()


def messages():
    """Fields of each type, with their types."""
    types = {'JointState': JOINT_STATE}
    for path in glob.glob(os.path.join(ROOT, 'msg', '*.msg')):
        name = os.path.basename(path)[:-len('.msg')]
        types[name] = {field: kind for kind, field in re.findall(r'^([\w/]+(?:\[\])?) +(\w+) *(?:#.*)?$', read('msg', name + '.msg'), re.M)}
    return types


class Layouts(unittest.TestCase):
    def setUp(self):
        self.ring = yaml.safe_load(read('config', 'humanoid16.yaml'))
        self.types = messages()
        sources = ''.join(read('ros_bridge', name) for name in os.listdir(os.path.join(ROOT, 'ros_bridge')) if name.endswith('.cpp'))
        self.topics = {'/' + topic: kind for kind, topic in re.findall(r'advertise<(?:\w+::)?(\w+)>\("(\w+)"', sources)}
        self.assertIn('subscribe(nodes, "joint_commands")', sources)
        self.topics['/joint_commands'] = 'JointState'
        self.topics.update({'/states/' + node['name']: 'JointState' for node in self.ring['nodes'] if node.get('joints')})

    def kind_of(self, topic, fields, path):
        """The type at the end of fields, such as ['nodes[10]', 'state']."""
        self.assertIn(topic, self.topics, path)
        kind = self.topics[topic]
        for field in fields:
            name, place = re.fullmatch(r'(\w+)(?:\[(\d+|:)\])?', field).groups()
            self.assertIn(name, self.types[kind], path)
            kind = self.types[kind][name]
            self.assertEqual(kind.endswith('[]'), place is not None, path)
            if place and place != ':':
                self.assertLess(int(place), len(self.ring['nodes']), path)
            kind = kind.replace('[]', '')
        return kind

    def test_curves_of_plotjuggler_are_numbers_of_our_topics(self):
        joints = [joint['name'] for node in self.ring['nodes'] for joint in node.get('joints', [])]
        curves = [curve.get('name') for curve in xml.etree.ElementTree.fromstring(read('config', 'plotjuggler.xml')).iter('curve')]
        self.assertGreater(len(curves), 20)
        for path in curves:
            topic, *fields = path[1:].split('/')
            if self.topics.get('/' + topic) == 'JointState':  # by the joint's name, as its plugin reads them
                self.assertIn(fields.pop(0), joints, path)
                fields = [fields[0] + '[:]']
            self.assertRegex(self.kind_of('/' + topic, fields, path), '^(float64|u?int[0-9]+|bool)$', path)

    def test_paths_of_foxglove_are_fields_of_our_topics_and_its_filters_too(self):
        layout = json.loads(read('config', 'foxglove.json'))
        self.assertIn(layout['globalVariables']['node'], [node['name'] for node in self.ring['nodes']])
        for name, panel in layout['configById'].items():
            paths = [path['value'] for path in panel.get('paths', [])] or [panel['topicPath']]
            for path in paths:
                topic, *fields = re.sub(r'\{.*?\}', '', path).split('.')
                kind = self.kind_of(topic, fields, path)
                if name.startswith('Plot!'):
                    self.assertRegex(kind, '^(float64|u?int[0-9]+|bool)$', path)
                for field, variable in re.findall(r'\{(\w+)==\$(\w+)\}', path):
                    self.assertIn(field, self.types['NodeStatus'], path)
                    self.assertIn(variable, layout['globalVariables'], path)

    def test_every_panel_of_foxglove_has_a_place(self):
        layout, placed = json.loads(read('config', 'foxglove.json')), []

        def visit(part):
            if isinstance(part, str):
                placed.append(part)
            else:
                visit(part['first'])
                visit(part['second'])
        visit(layout['layout'])
        self.assertEqual(sorted(placed), sorted(layout['configById']))

    def test_the_page_records_the_topics_that_the_layouts_show(self):
        recorded = set(re.search(r'^rosbag record (.*)$', read('docs', 'how-to', 'plots.md'), re.M).group(1).split())
        shown = set(re.findall(r'"(/(?:states/)?\w+)[/."]', read('config', 'plotjuggler.xml') + read('config', 'foxglove.json')))
        self.assertEqual(shown, recorded)


if __name__ == '__main__':
    unittest.main()
