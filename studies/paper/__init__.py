"""The whole paper through the packed FMU: figures 2 to 12, A.1, B.1 to B.4, tables 1 to 4, and some more.

    make paper            or            PYTHONPATH=studies python -m paper --help

Each module holds one topic and returns `entries.Entry` objects: a drawing, the numbers behind it, and
what there is to say about it. Only `equation` and `independent` compute without the FMU.
"""
