"""The process that forks the readers of files, and other processes."""
import os
import signal
import subprocess
import sys
import time

import pytest

HEAD = """
import os, sys, threading, time
import numpy, lefort
lefort.write_surface("a.stl", lefort.TriangleMesh([[0,0,0],[1,0,0],[0,1,0],[0,0,1]], [[0,2,1],[0,1,3],[1,2,3],[0,3,2]]))
"""


def run(code: str, folder, before: str = "") -> subprocess.CompletedProcess[str]:
    (folder / "main.py").write_text(before + HEAD + code)
    return subprocess.run([sys.executable, "main.py"], cwd=folder, capture_output=True, text=True, timeout=120)


def readers_below(parent: int) -> list[str]:
    """Names and states of the children of a process."""
    found = []
    for entry in os.listdir("/proc"):
        if entry.isdigit():
            try:
                with open(f"/proc/{entry}/stat", encoding="ascii", errors="replace") as file:
                    name, rest = file.read().split("(", 1)[1].rsplit(") ", 1)
            except OSError:
                continue
            if int(rest.split()[1]) == parent:
                found.append(f"{name} {rest.split()[0]}")
    return found


def test_the_readers_start_with_the_import_and_end_with_the_program(tmp_path):
    code = """
lefort.read_surface("a.stl")
print(os.getpid(), flush=True)
sys.stdin.read()
"""
    (tmp_path / "main.py").write_text(HEAD + code)
    with subprocess.Popen([sys.executable, "main.py"], cwd=tmp_path, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                          text=True) as process:
        pid = int(process.stdout.readline())
        assert readers_below(pid) in (["lefort-readers S"], ["lefort-readers R"])
        process.stdin.close()
        assert process.wait(30) == 0
    assert not readers_below(pid)


def test_the_exit_is_clean_even_while_threads_compute(tmp_path):
    code = """
def compute():
    vertices = numpy.random.default_rng(1).uniform(-50, 50, (3000, 3))
    mesh = lefort.TriangleMesh(vertices, numpy.arange(3000).reshape(-1, 3))
    while True:
        lefort.DistanceField.build(mesh, resolution=128)

threading.Thread(target=compute, daemon=True).start()
time.sleep(0.2)
"""
    done = run(code, tmp_path)
    assert (done.returncode, done.stderr) == (0, "")


def test_functions_called_at_exit_may_use_lefort(tmp_path):
    before = "import atexit; atexit.register(lambda: at_exit())"  # Called after the handler of lefort.
    code = """
def at_exit():
    print(lefort.DistanceField.build(lefort.read_surface("a.stl"), resolution=16).resolution)
"""
    done = run(code, tmp_path, before=before)
    assert (done.returncode, done.stdout, done.stderr) == (0, "16\n", "")


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_processes_of_multiprocessing_read_and_compute(tmp_path, method):
    code = f"""
import multiprocessing

def work(number):
    mesh = lefort.read_surface("a.stl")
    field = lefort.DistanceField.build(mesh, resolution=32)
    return number, float(field.distance([0.1, 0.1, 0.05]))

if __name__ == "__main__":
    expected = work(0)[1]  # In this process first: with its threads.
    with multiprocessing.get_context("{method}").Pool(2) as pool:
        assert pool.map(work, range(4)) == [(n, expected) for n in range(4)]
    lefort.read_surface("a.stl")  # The readers are still there.
    print("done")
"""
    done = run(code, tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", "")


def test_a_forked_process_may_live_longer_and_still_reads(tmp_path):
    code = """
pid = os.fork()
if pid == 0:
    while os.getppid() != 1 and not os.path.exists("parent has ended"):
        time.sleep(0.01)
    time.sleep(0.2)
    lefort.read_surface("a.stl")
    open("child has read", "w").close()
    sys.exit(0)
"""
    (tmp_path / "main.py").write_text(HEAD + code)
    begun = time.monotonic()
    assert subprocess.run([sys.executable, "main.py"], cwd=tmp_path, timeout=60, check=False).returncode == 0
    (tmp_path / "parent has ended").touch()
    while not (tmp_path / "child has read").exists():
        assert time.monotonic() - begun < 60
        time.sleep(0.05)


def test_ctrl_c_ends_a_program_with_keyboard_interrupt(tmp_path):
    code = """
print("ready", flush=True)
vertices = numpy.random.default_rng(1).uniform(-50, 50, (3000, 3))
mesh = lefort.TriangleMesh(vertices, numpy.arange(3000).reshape(-1, 3))
while True:
    lefort.DistanceField.build(mesh, resolution=128)
"""
    (tmp_path / "main.py").write_text(HEAD + code)
    with subprocess.Popen([sys.executable, "main.py"], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True) as process:
        process.stdout.readline()
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
    assert process.returncode in (-signal.SIGINT, 130, 1) and errors.rstrip().endswith("KeyboardInterrupt")


def test_a_hostile_file_is_an_error_and_the_next_one_is_read(tmp_path):
    code = """
with open("b.vtp", "wb") as file:
    file.write(b"<VTKFile type='PolyData'>" + b"<a>" * 200000)
for name in ("b.vtp", "a.stl"):
    try:
        print(lefort.read_surface(name))
    except lefort.Error as error:
        print(error.code)
"""
    done = run(code, tmp_path)
    assert done.stdout == "file_corrupt\n<lefort.TriangleMesh: 4 vertices, 4 triangles>\n"
