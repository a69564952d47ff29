"""The node beside a bare rclpy node that publishes or echoes the same bytes."""
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from statistics import median

ROOT = Path(__file__).resolve().parent.parent
PAPER = {'linkage.a1': 0.4, 'linkage.a2': 1.2, 'linkage.a3': 0.8, 'linkage.a4': 1.0,
         'bodies.rods.density': 7750.0, 'bodies.rods.radius': 0.01, 'drive.speed': 25.0}
KINEMATICS = ['state']
FULL = ['state', 'output', 'joint_states', 'loads', 'shaking_wrench']
ROUNDS, SECONDS = 3, 4.0
CLOCK_TICK = os.sysconf('SC_CLK_TCK')
os.environ.setdefault('ROS_DOMAIN_ID', str(1 + os.getpid() % 100))


class Child:
    """A process under measurement."""

    def __init__(self, *command):
        self.began = time.monotonic()
        self.process = subprocess.Popen([sys.executable, *command], cwd=ROOT, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL)

    def cpu(self):
        """Return the CPU time used so far [s]."""
        fields = Path(f'/proc/{self.process.pid}/stat').read_text().rsplit(')', 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / CLOCK_TICK

    def rss(self):
        """Return the resident memory [MB]."""
        return int(Path(f'/proc/{self.process.pid}/statm').read_text().split()[1]) * os.sysconf('SC_PAGE_SIZE') / 1e6

    def stop(self):
        """End it; return how long that took [s]."""
        began = time.monotonic()
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(20)
        return time.monotonic() - began


def node(parameters):
    """Start fourbar_node with these parameters."""
    file = Path(tempfile.mkdtemp()) / 'scene.yaml'
    file.write_text(json.dumps({'/**': {'ros__parameters': {**PAPER, **parameters}}}))
    return Child('-m', 'fourbar_ros.ros.node', '--ros-args', '--params-file', str(file))


def bare(kind, rate=1.0, outputs=KINEMATICS):
    """Start the bare node."""
    return Child('-m', 'bench.bare', kind, str(rate), *outputs)


class Listener:
    """Hears the state topic of a child in raw bytes: arrival times and stamps; and drives its input."""

    def __init__(self, name, others=()):
        import rclpy
        from fourbar_msgs.msg import LinkageState, Motion
        from rclpy.experimental import EventsExecutor
        self.node = rclpy.create_node('listener')
        self.arrived = []
        self.node.create_subscription(LinkageState, f'/{name}/state', self._take, 1000, raw=True)
        for topic, kind in others:
            self.node.create_subscription(kind, topic, lambda data: None, 1000, raw=True)
        self.publisher = self.node.create_publisher(Motion, f'/{name}/input', 10)
        self.executor = EventsExecutor()
        self.executor.add_node(self.node)
        self.running = True
        self.thread = threading.Thread(target=self._spin, daemon=True)
        self.thread.start()

    def _spin(self):
        while self.running:
            self.executor.spin_once(timeout_sec=0.1)

    def _take(self, data):
        now = time.time_ns()                        # CDR: 4 bytes of header, then sec, nanosec
        self.arrived.append((now, int.from_bytes(data[4:8], 'little') * 10**9
                             + int.from_bytes(data[8:12], 'little')))

    def wait(self, poke=None):
        """Wait for the first message."""
        end = time.monotonic() + 20.0
        while not self.arrived and time.monotonic() < end:
            if poke:
                poke()
            time.sleep(0.02)
        if not self.arrived:
            raise RuntimeError('nothing heard')

    def close(self):
        """Leave the graph."""
        self.running = False
        self.thread.join()
        self.executor.shutdown()
        self.node.destroy_node()


def others_of(name, outputs):
    """Return topics and types beside the state, so that every output is heard."""
    from fourbar_ros.interfaces import OUTPUTS
    from fourbar_ros.ros.messages import resolve
    return [(OUTPUTS[o].topic.replace('~', f'/{name}'), resolve(OUTPUTS[o].type)) for o in outputs if o != 'state']


def percentile(values, share):
    """Return a percentile of a list."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))]


def timed(make, name, rate, outputs, seconds=SECONDS):
    """Return (rate got, late p50, p99 [us], CPU per step [us]) of a timer stream."""
    child = make()
    listener = Listener(name, others_of(name, outputs))
    try:
        listener.wait()
        time.sleep(0.5)
        cpu, count, began = child.cpu(), len(listener.arrived), time.monotonic()
        time.sleep(seconds)
        cpu, got, took = child.cpu() - cpu, listener.arrived[count:], time.monotonic() - began
    finally:
        child.stop()
        listener.close()
    late = [(arrived - stamp) * 1e-3 for arrived, stamp in got]
    return len(got) / took, percentile(late, 0.5), percentile(late, 0.99), cpu / max(len(got), 1) * 1e6


def timers():
    """Print the timer table."""
    print('| stream | node | rate got [Hz] | late p50 [us] | late p99 [us] | CPU per step [us] |')
    print('| --- | --- | --- | --- | --- | --- |')
    for what, rate, outputs in (('kinematics only', 1000.0, KINEMATICS), ('full loads, 5 topics', 500.0, FULL)):
        rows = {'bare': [], 'fourbar': []}
        for _ in range(ROUNDS):                     # in turn, so that both see the same machine
            rows['bare'].append(timed(lambda: bare('timer', rate, outputs), 'bare', rate, outputs))
            rows['fourbar'].append(timed(lambda: node({'drive.rate': rate, 'outputs': outputs}), 'fourbar', rate,
                                         outputs))
        medians = {name: [median(column) for column in zip(*found)] for name, found in rows.items()}
        for name, values in medians.items():
            print(f'| {what}, {rate:g} Hz | {name} | ' + ' | '.join(f'{v:.1f}' for v in values) + ' |')
        ratios = [a / b for a, b in zip(medians['fourbar'], medians['bare'])]
        print('| | ratio | ' + ' | '.join(f'{v:.2f}' for v in ratios) + ' |')
    print()


def highest():
    """Print the highest rate each holds (99.9 % of the samples heard)."""
    print('| stream | bare [Hz] | fourbar [Hz] |\n| --- | --- | --- |')
    for what, outputs in (('kinematics only', KINEMATICS), ('full loads, 5 topics', FULL)):
        held = {'bare': 0, 'fourbar': 0}
        for name in held:
            for rate in (500, 1000, 2000, 3000, 4000, 5000):
                def make(name=name, rate=rate):
                    return (bare('timer', rate, outputs) if name == 'bare'
                            else node({'drive.rate': float(rate), 'outputs': outputs}))
                if timed(make, name, rate, outputs, 2.0)[0] < 0.995 * rate:
                    break
                held[name] = rate
        print(f'| {what} | {held["bare"]} | {held["fourbar"]} |')
    print()


def echoed(make, name, rate, seconds):
    """Return (lost, p50, p99 [us], CPU per message [us]) of input to output."""
    from fourbar_msgs.msg import Motion
    child = make()
    listener = Listener(name)
    message = Motion(position=0.3, velocity=1.0)

    def send():
        now = time.time_ns()
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(now, 10**9)
        listener.publisher.publish(message)

    try:
        listener.wait(send)
        time.sleep(0.5)
        cpu, count, began = child.cpu(), len(listener.arrived), time.monotonic()
        total = int(rate * seconds)
        for k in range(total):
            wait = began + k / rate - time.monotonic()
            if wait > 0.0:
                time.sleep(wait)
            message.position = 0.001 * k
            send()
        time.sleep(0.5)
        cpu, got = child.cpu() - cpu, listener.arrived[count:]
    finally:
        child.stop()
        listener.close()
    took = [(arrived - stamp) * 1e-3 for arrived, stamp in got]
    return total - len(got), percentile(took, 0.5), percentile(took, 0.99), cpu / total * 1e6


def echoes():
    """Print the latency table."""
    print('| input to output, 1 kHz | lost | p50 [us] | p99 [us] | CPU per message [us] |')
    print('| --- | --- | --- | --- | --- |')
    rows = {'bare': [], 'fourbar': []}
    for _ in range(ROUNDS):
        rows['bare'].append(echoed(lambda: bare('echo'), 'bare', 1000.0, SECONDS))
        rows['fourbar'].append(echoed(lambda: node({'drive.source': 'motion', 'outputs': KINEMATICS}), 'fourbar',
                                      1000.0, SECONDS))
    medians = {name: [median(column) for column in zip(*found)] for name, found in rows.items()}
    for name, values in medians.items():
        print(f'| {name} | ' + ' | '.join(f'{v:.1f}' for v in values) + ' |')
    print('| ratio | | ' + ' | '.join(f'{a / b:.2f}' for a, b in zip(medians['fourbar'][1:], medians['bare'][1:]))
          + ' |')
    lost, *_ = echoed(lambda: node({'drive.source': 'motion', 'outputs': KINEMATICS}), 'fourbar', 1000.0, 60.0)
    print(f'\nOne minute at 1 kHz, publisher depth 10: {lost} of 60000 lost.\n')


def scenes():
    """Print what scenes cost."""
    print('| scene at 200 Hz | CPU per step [us] | memory [MB] | start to first message [s] | SIGTERM to exit [s] |')
    print('| --- | --- | --- | --- | --- |')
    for what, outputs, heard in (('all outputs', FULL, FULL), ('kinematics only', ['state', 'output', 'joint_states'],
                                                               ['state', 'output', 'joint_states']),
                                 ('state only', KINEMATICS, KINEMATICS), ('all outputs, only state heard', FULL, KINEMATICS),
                                 ('all outputs, nobody listening', FULL, None)):
        child = node({'drive.rate': 200.0, 'outputs': outputs})
        listener = Listener('fourbar' if heard else 'nobody', others_of('fourbar', heard) if heard else ())
        if heard:
            listener.wait()
            first = f'{time.monotonic() - child.began:.2f}'
        else:
            time.sleep(2.0)
            first = '-'
        time.sleep(0.5)
        cpu = child.cpu()
        time.sleep(5.0)
        cpu, rss = child.cpu() - cpu, child.rss()
        left = child.stop()
        listener.close()
        print(f'| {what} | {cpu / 1000 * 1e6:.0f} | {rss:.0f} | {first} | {left:.2f} |')
    print()


def requests():
    """Print what a request for all extremes with proof, in both modes, does to a stream of 200 Hz."""
    from fourbar_msgs.srv import FindExtrema
    print('| stream of 200 Hz | answered in [s] | rate got [Hz] | largest gap [ms] | gap p99 [ms] |')
    print('| --- | --- | --- | --- | --- |')
    child = node({'drive.rate': 200.0, 'outputs': KINEMATICS})
    listener = Listener('fourbar')
    client = listener.node.create_client(FindExtrema, '/fourbar/find_extrema')

    def ask_all():
        future = client.call_async(FindExtrema.Request(velocity=25.0, mode=FindExtrema.Request.MODE_BOTH, certify=True))
        while not future.done():
            time.sleep(0.002)

    try:
        listener.wait()
        client.wait_for_service(20.0)
        time.sleep(1.0)
        for what, ask in (('nothing asked', lambda: time.sleep(SECONDS)), ('everything asked, with proof', ask_all)):
            count, began = len(listener.arrived), time.monotonic()
            ask()
            took, arrived = time.monotonic() - began, [moment for moment, _ in listener.arrived[count:]]
            gaps = [(b - a) * 1e-6 for a, b in zip(arrived, arrived[1:])]
            print(f'| {what} | {took:.1f} | {len(arrived) / took:.1f} | {max(gaps):.1f} | {percentile(gaps, 0.99):.1f} |')
    finally:
        child.stop()
        listener.close()
    print()


def imports():
    """Print how long imports take in a fresh Python."""
    print('| import, in a fresh Python | wall time [ms] | over that of rclpy |')
    print('| --- | --- | --- |')
    modules = {'nothing': 'sys', 'fourbar_ros.core (no ROS)': 'fourbar_ros.core', 'rclpy': 'rclpy',
               'the node': 'fourbar_ros.ros.node', 'the node and its recorder': 'fourbar_ros.ros.node, fourbar_ros.bag.writer'}
    took = {what: [] for what in modules}
    for _ in range(2 * ROUNDS + 1):
        for what, module in modules.items():
            began = time.monotonic()
            subprocess.run([sys.executable, '-c', f'import {module}'], check=True, cwd=ROOT)
            took[what].append((time.monotonic() - began) * 1e3)
    whole = median(took['rclpy'])
    for what, times in took.items():
        print(f'| {what} | {median(times):.0f} | {median(times) / whole:.2f} |')
    print()


def main():
    """Print all tables of the node."""
    import rclpy
    rclpy.init()
    try:
        timers()
        highest()
        echoes()
        scenes()
        requests()
        imports()
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
