"""Validates OpenAPI documents with openapi-spec-validator.

Prints one JSON line per document: its path, and its errors as texts with document and JSON pointer.
"""

import json
import sys

from openapi_spec_validator import OpenAPIV31SpecValidator


def pointer(keys):
    return "".join("/" + str(key).replace("~", "~0").replace("/", "~1") for key in keys)


def validate(path):
    with open(path, encoding="utf-8") as file:
        document = json.load(file)
    errors = OpenAPIV31SpecValidator(document).iter_errors()
    return [f"{path}#{pointer(error.absolute_path)}: {error.message}" for error in errors]


for path in sys.argv[1:]:
    print(json.dumps({"document": path, "errors": validate(path)}))
