"""Replies to requests line by line: the counterpart of `bench/src/python_peer.rs`."""

import json
import sys
import time


def timed(work):
    """Returns the result of `work` and the CPU time of all threads of this process, in seconds."""
    begin = time.process_time()
    result = work()
    return result, time.process_time() - begin


def serve(jobs):
    """Reads a request `{"job": NAME, ...}` per line and replies with the result of that function.

    The function receives the other keys as arguments and returns a dictionary. Measurements have the
    key `seconds`. The first request is the job `start`, which imports slow or optional packages.
    """
    jobs = {"start": lambda: {}, **jobs}
    for line in sys.stdin:
        request = json.loads(line)
        try:
            reply = json.dumps(jobs[request.pop("job")](**request), allow_nan=False, default=float)
        except Exception as error:
            reply = json.dumps({"error": f"{type(error).__name__}: {error}".splitlines()[0]})
        print(reply, flush=True)
