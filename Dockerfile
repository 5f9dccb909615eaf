FROM python:3.11-slim

# One environment from the hashed lock, compiled now because the image's files can't be written later.
COPY requirements.lock /srv/ponthy/
RUN python -m venv /srv/venv \
    && /srv/venv/bin/pip install --no-cache-dir --require-hashes --no-deps -r /srv/ponthy/requirements.lock \
    && echo /srv/ponthy > /srv/venv/lib/python3.11/site-packages/ponthy.pth

COPY LICENSE NOTICE /srv/ponthy/
COPY migrations /srv/ponthy/migrations
COPY frontend /srv/ponthy/frontend
COPY workers /srv/ponthy/workers
COPY app /srv/ponthy/app
RUN /srv/venv/bin/python -m compileall -q /srv/ponthy/app /srv/ponthy/workers

RUN useradd --system --uid 10001 --home-dir /srv/ponthy ponthy \
    && mkdir -p /var/lib/ponthy /var/cache/ponthy \
    && chown ponthy:ponthy /var/lib/ponthy /var/cache/ponthy
USER ponthy
WORKDIR /var/lib/ponthy

ENV PATH=/srv/venv/bin:$PATH \
    PYTHONUNBUFFERED=1 \
    NUMBA_CACHE_DIR=/var/cache/ponthy/numba \
    MPLCONFIGDIR=/var/cache/ponthy/matplotlib \
    PONTHY_DATA_DIR=/var/lib/ponthy \
    PONTHY_LOG_JSON=true

# Compiled kernels come with the image; on another kind of processor a worker compiles its own into the same folder.
RUN python -P -m app.cli warm && python -P -m workers warm filters

VOLUME ["/var/lib/ponthy", "/var/cache/ponthy"]
EXPOSE 8321
ENTRYPOINT ["python", "-P", "-m", "app.cli"]
CMD ["web", "--host", "0.0.0.0"]
