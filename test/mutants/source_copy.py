"""A copy of the sources, to be changed and built."""
import pathlib
import shutil
import subprocess

SOURCES = pathlib.Path(__file__).resolve().parents[2]


def folder_of_copies(name):
    """Hidden: roslaunch looks everywhere else below the package, also in build/, and would find each launch file twice."""
    return SOURCES / 'build' / ('.' + name)


def copy_sources(folder, changed=None):
    """Makes `folder` the same as the sources; a file that is so already keeps its date, so that it is not built again.

    @param changed text of files that are to be different, by their paths from the top
    """
    changed = changed or {}
    listed = subprocess.run(['git', 'ls-files'], cwd=str(SOURCES), check=True, stdout=subprocess.PIPE)
    for name in sorted(set(listed.stdout.decode().split('\n')) | set(changed)):
        source, copy = SOURCES / name, folder / name
        if name in changed:
            content = changed[name].encode('utf-8')
        elif name and source.is_file():
            content = source.read_bytes()
        else:
            continue
        copy.parent.mkdir(parents=True, exist_ok=True)
        if not copy.exists() or copy.read_bytes() != content:
            copy.write_bytes(content)
            if source.exists():
                shutil.copymode(str(source), str(copy))
