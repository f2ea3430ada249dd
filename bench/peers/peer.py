"""Answers questions line by line: the other end of `bench/src/python_peer.rs`."""

import json
import sys
import time


def timed(work):
    """What `work` returns, and the seconds that all threads of this process worked for it."""
    begin = time.process_time()
    result = work()
    return result, time.process_time() - begin


def serve(jobs):
    """Reads a question `{"job": NAME, ...}` a line, and answers with what the function of that name returns for the rest.

    The functions return dictionaries; those that measure have `seconds` among their keys. The first question is for the job `start`,
    which may import what is slow or may be missing.
    """
    jobs = {"start": lambda: {}, **jobs}
    for line in sys.stdin:
        question = json.loads(line)
        try:
            answer = json.dumps(jobs[question.pop("job")](**question), allow_nan=False, default=float)
        except Exception as error:
            answer = json.dumps({"error": f"{type(error).__name__}: {error}".splitlines()[0]})
        print(answer, flush=True)
