"""Fewer cases where each takes much longer, as test/fewer_cases.h has it for tests in C++."""
import os


def fewer_cases_of(cases):
    """The cases to run of a list: the last one and every so many before it, in their order."""
    step = max(1, int(os.environ.get('CLOTH_SIM_FEWER_CASES', '1')))
    return cases[(len(cases) - 1) % step::step]
