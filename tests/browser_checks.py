"""What tests of pages in a browser share: the windows' sizes, and failures that are said and counted."""

SIZES = {"desk": {"width": 1400, "height": 900}, "phone": {"width": 390, "height": 844}}
failures = []


def expect(what, holds, said=""):
    if not holds:
        failures.append(what)
        print(f"FAILED {what}: {said}")
