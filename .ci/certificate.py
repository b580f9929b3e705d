#!/usr/bin/env python3
"""certificate.py REPORT.JSON: prints the certificate of a mesh report for people."""
import json
import sys

with open(sys.argv[1], encoding='utf-8') as file:
    report = json.load(file)
print('\ncertificate')
for name, value in {**report['counts'], **report['certificate']}.items():
    print(f'  {name:<16} {json.dumps(value)}')
