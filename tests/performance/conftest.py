"""An option of these tests."""


def pytest_addoption(parser):
    parser.addoption("--bless", action="store_true", help="write what is counted as the new bounds")
