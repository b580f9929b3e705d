#!/usr/bin/env python3
"""Counts the cases of a meson test run (testlog.json) and prints `N passed, N failed[, N skipped]`.

meson's own summary counts programs. Here every line of a program's TAP output is a case, what its plan promises and
its output lacks has failed, and so has a program that ended badly for any other reason. Exits with 1 if anything
failed or nothing ran."""
import argparse
import json
import os
import re
import sys

RESULT = re.compile(r'^(not )?ok\b[^#]*(#\s*skip\b)?', re.IGNORECASE)
PLAN = re.compile(r'^1\.\.(\d+)\s*(#\s*skip\b)?', re.IGNORECASE)


def count_tap(text):
    passed = failed = skipped = 0
    promised = None
    for line in text.splitlines():
        plan, result = PLAN.match(line), RESULT.match(line)
        if plan:
            promised = (promised or 0) + int(plan.group(1))
            skipped += bool(plan.group(2))
        elif result and result.group(2):
            skipped += 1
        elif result and result.group(1):
            failed += 1
        elif result:
            passed += 1
    missing = max(0, (promised or 0) - passed - failed - skipped)
    return passed, failed + missing, skipped, promised is not None


def count_program(record):
    result = record['result']
    passed, failed, skipped, is_tap = count_tap(record.get('stdout') or '')
    if not is_tap:
        return int(result == 'OK'), int(result not in ('OK', 'SKIP')), int(result == 'SKIP')
    if result not in ('OK', 'SKIP') and failed == 0:
        failed = 1
    return passed, failed, skipped


def count_log(path):
    totals = [0, 0, 0]
    with open(path, encoding='utf-8') as log:
        for line in filter(str.strip, log):
            record = json.loads(line)
            counts = count_program(record)
            totals = [total + count for total, count in zip(totals, counts)]
            if counts[1]:
                print(f"failed: {record['name']}")
    return totals


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('log', help="meson's testlog.json")
    parser.add_argument('--status', type=int, default=0, help='how meson test exited')
    arguments = parser.parse_args()
    passed, failed, skipped = count_log(arguments.log) if os.path.exists(arguments.log) else (0, 0, 0)
    if failed == 0 and (arguments.status != 0 or passed + skipped == 0):
        print(f'failed: the run itself (meson test exited with {arguments.status})')
        failed = 1
    print(f'{passed} passed, {failed} failed' + (f', {skipped} skipped' if skipped else ''))
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())
