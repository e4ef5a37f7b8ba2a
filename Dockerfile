# Build: docker build -t paretour .
# Run:   docker run --read-only -p 8000:8000 paretour

FROM python:3.11-slim AS build
WORKDIR /source
COPY pyproject.toml README.md LICENSE ./
COPY service ./service
COPY models ./models
COPY export ./export
RUN python -m venv /opt/paretour \
    && /opt/paretour/bin/pip install --no-cache-dir -c service/deploy/constraints.txt '.[cluster,mcp,tracing]' \
    && mkdir /var/lib/paretour /var/cache/paretour
# Compile the search into the package: on x86-64, for processors of any name. Outside the source,
# where the installed package would be shadowed.
WORKDIR /opt/paretour
RUN ["/opt/paretour/bin/python", "-m", "service.jobs.precompile"]

# The same interpreter at the same path, so that the virtual environment works as it is.
FROM python:3.11-slim
COPY --from=build /opt/paretour /opt/paretour
COPY --from=build --chown=10001:10001 /var/cache/paretour /var/cache/paretour
# Where a volume may be mounted that fronts outlive the container in, as PARETOUR_STORE says.
COPY --from=build --chown=10001:10001 /var/lib/paretour /var/lib/paretour
# Nothing else is written: not even bytecode, which pip has compiled.
ENV PATH=/opt/paretour/bin:$PATH \
    PYTHONDONTWRITEBYTECODE=1 \
    PYTHONUNBUFFERED=1 \
    NUMBA_CACHE_DIR=/var/cache/paretour \
    PARETOUR_HOST=0.0.0.0 \
    PARETOUR_PORT=8000
# A number, so that an orchestrator can tell that it is not root.
USER 10001:10001
# Empty, and stays so, unless the build compiled for another level of processors. What is compiled
# anew for these is kept there: a volume stays writable where the root is not.
VOLUME /var/cache/paretour
EXPOSE 8000
HEALTHCHECK --interval=10s --timeout=3s --start-period=10s --retries=3 \
    CMD ["python", "-c", "import os, urllib.request; urllib.request.urlopen('http://127.0.0.1:' + os.environ['PARETOUR_PORT'] + '/health/live', timeout=2)"]
STOPSIGNAL SIGTERM
CMD ["paretour", "serve"]
