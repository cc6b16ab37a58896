#!/usr/bin/env python3
"""What `arapctl plan` says of 1, 2 and 3 servers beside what `arapctl load` measures of them.

Usage: tests/bench/replicas.py [--bin FOLDER] [--vertices N] [--seconds S] [--rates N,...] [--json FILE]

Measures what an update takes a server (processor time over updates, in a closed loop of four streams), then, for each number of
servers with one worker each, runs them all at once under an open loop of --rates updates a second for each server,
and asks `arapctl plan` how long updates should take there. Servers and generators share the machine: rates at which
all of them together fill its processors are told and left out.
"""
import argparse
import contextlib
import json
import math
import os
import subprocess
import sys
import tempfile

STREAMS = 20
HANDLES = 8
TICKS = os.sysconf("SC_CLK_TCK")


def processor_seconds(pid):
    with open(f"/proc/{pid}/stat", encoding="ascii") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


@contextlib.contextmanager
def servers(folder, count):
    """(process, address) of so many servers with one worker each, which end with the block."""
    with tempfile.TemporaryDirectory() as place:
        running = []
        try:
            for number in range(count):
                address = f"unix:{place}/{number}"
                process = subprocess.Popen(
                    [f"{folder}/arapd", "--listen", address, "--store", "memory", "--no-admin", "--log-level", "warn",
                     "--workers", "1", "--max-stream-load", "0", "--access-log", "off"],
                    stdout=subprocess.PIPE, text=True)
                running.append((process, address))
                process.stdout.readline()
            yield running
        finally:
            for process, _ in running:
                process.kill()
                process.wait()


def load(folder, addresses, arguments, rate, seconds):
    """The results of one `arapctl load` for each address, all at once; without a rate of a closed loop."""
    with tempfile.TemporaryDirectory() as place:
        runs = [
            subprocess.Popen(
                [f"{folder}/arapctl", "load", "--server", address, "--quiet", "--json", f"{place}/{number}",
                 "--vertices", str(arguments.vertices), "--handles", str(HANDLES), "--sessions", "1",
                 "--seconds", str(seconds), "--warm-up", "1", "--seed", str(number),
                 *(["--streams", str(STREAMS), "--rate", str(rate)] if rate else ["--streams", "4"])], stdout=subprocess.DEVNULL)
            for number, address in enumerate(addresses)
        ]
        for run in runs:
            if run.wait() != 0:
                sys.exit("arapctl load has failed")
        results = []
        for number in range(len(runs)):
            with open(f"{place}/{number}", encoding="utf-8") as file:
                results.append(json.load(file))
        return results


def service_time(folder, arguments):
    """Seconds of the server's processor time for an update and of the generator's in a closed loop, and how much the
    time of a frame differs from one to the next (deviation over mean of a lognormal distribution)."""
    with servers(folder, 1) as [(process, address)]:
        load(folder, [address], arguments, None, 0.2)
        start = processor_seconds(process.pid)
        [short] = load(folder, [address], arguments, None, 0.2)
        middle = processor_seconds(process.pid)
        [long] = load(folder, [address], arguments, None, arguments.seconds)
        end = processor_seconds(process.pid)
    updates = long["updates"] - short["updates"]
    server = ((end - middle) - (middle - start)) / updates
    spread = math.log(long["solve_micros"]["p90"] / long["solve_micros"]["p50"]) / 1.2816
    return server, long["own_nanos_per_message"] / 1e9, math.sqrt(math.expm1(spread**2))


def plan(folder, arguments, count, rate, seconds):
    told = subprocess.run(
        [f"{folder}/arapctl", "plan", "--json", "--puppets", str(STREAMS * count), "--fps", str(rate / STREAMS),
         "--vertices", str(arguments.vertices), "--handles", str(HANDLES), "--replicas", str(count), "--cores", "1",
         "--update-micros", str(seconds * 1e6)],
        check=True, capture_output=True, text=True)
    return json.loads(told.stdout)


def main():
    root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default=f"{root}/build/release/bin", metavar="FOLDER")
    parser.add_argument("--vertices", type=int, default=10000)
    parser.add_argument("--seconds", type=float, default=5)
    parser.add_argument("--rates", type=lambda text: [int(part) for part in text.split(",")],
                        default=[100, 300, 500, 800], metavar="N,...")
    parser.add_argument("--json", metavar="FILE")
    arguments = parser.parse_args()
    processors = len(os.sched_getaffinity(0))
    server, generator, variation = service_time(arguments.bin, arguments)
    print(f"An update of {arguments.vertices:,} vertices takes the server {server * 1e6:.0f} µs and the generator "
          f"{generator * 1e6:.0f} µs of a processor;\nframes differ by {variation:.0%}.\n")
    print("| servers | updates a second of each | of a worker | planned: p50, p99 in the server (µs) | "
          "measured: queue and frame | round trip |")
    print("|---|---|---|---|---|---|")
    rows = []
    for count in (1, 2, 3):
        for rate in arguments.rates:
            if count * rate * (server + generator) > 0.6 * processors:
                print(f"{count} × {rate}/s would fill the {processors} processors of this machine: left out",
                      file=sys.stderr)
                continue
            planned = plan(arguments.bin, arguments, count, rate, server)
            with servers(arguments.bin, count) as running:
                runs = load(arguments.bin, [address for _, address in running], arguments, rate, arguments.seconds)

            def mean(pick):
                return sum(pick(run) for run in runs) / len(runs)

            row = {
                "servers": count, "rate": rate, "use": planned["use"]["cores"],
                "planned": [planned["time_micros"]["p50"], planned["time_micros"]["p99"]],
                "measured": [mean(lambda run, at=at: run["queue_micros"][at] + run["solve_micros"][at])
                             for at in ("p50", "p99")],
                "round_trip": [mean(lambda run, at=at: run["round_trip_micros"][at]) for at in ("p50", "p99")],
            }
            rows.append(row)
            print("| {servers} | {rate} | {use:.0%} | {planned[0]:.0f}, {planned[1]:.0f} | "
                  "{measured[0]:.0f}, {measured[1]:.0f} | {round_trip[0]:.0f}, {round_trip[1]:.0f} |".format(**row),
                  flush=True)
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump({"server_seconds": server, "generator_seconds": generator, "runs": rows}, file, indent=1)


if __name__ == "__main__":
    main()
