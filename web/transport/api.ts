import { address, download, request, type RequestOptions } from './http'

type Method = 'get' | 'post' | 'put' | 'delete'
type OperationOf<Resource, M extends Method> =
  Resource extends Record<M, infer Operation> ? Operation : never

/** Paths of a description that have an operation of this method. */
type PathWith<Paths, M extends Method> = {
  [Path in keyof Paths]: OperationOf<Paths[Path], M> extends never ? never : Path
}[keyof Paths] &
  string

type Parameter<Operation, In extends 'path' | 'query'> = Operation extends {
  parameters: Partial<Record<In, infer Values>>
}
  ? Exclude<Values, undefined>
  : never
type Body<Operation> = Operation extends {
  requestBody: { content: { 'application/json': infer Content } }
}
  ? Content
  : never
type Success = 200 | 201 | 202 | 204
/** Responses of an operation without those that are thrown as a {@link Problem}. */
type Succeeded<Operation> = Operation extends { responses: infer Responses }
  ? Responses[keyof Responses & Success]
  : never
type Answer<Operation> =
  Succeeded<Operation> extends { content: { 'application/json': infer Content } }
    ? Content
    : undefined

/** Optional member if its value may be empty, and required member otherwise. */
type Member<Name extends string, Value> = [Value] extends [never]
  ? unknown
  : Record<never, never> extends Value
    ? Partial<Record<Name, Value>>
    : Record<Name, Value>

type Parameters<Operation> = Member<'path', Parameter<Operation, 'path'>> &
  Member<'query', Parameter<Operation, 'query'>>
type Input<Operation> = Parameters<Operation> &
  Member<'body', Body<Operation>> &
  Omit<RequestOptions, 'body' | 'text' | 'contentType'>

/** Optional as a whole where nothing in it is required. */
type Arguments<Input> = Record<never, never> extends Input ? [input?: Input] : [input: Input]

interface AnyInput extends RequestOptions {
  path?: Record<string, string | number>
  query?: Record<string, string | number | boolean | null | undefined>
}

/**
 * The API of the daemon that served this page, typed by its description: `Paths` as
 * openapi-typescript generates them. Every call throws {@link Problem} where it does not succeed.
 */
export class Api<Paths> {
  get<Path extends PathWith<Paths, 'get'>>(
    path: Path,
    ...[input]: Arguments<Input<OperationOf<Paths[Path], 'get'>>>
  ): Promise<Answer<OperationOf<Paths[Path], 'get'>>> {
    return send('GET', path, input)
  }

  post<Path extends PathWith<Paths, 'post'>>(
    path: Path,
    ...[input]: Arguments<Input<OperationOf<Paths[Path], 'post'>>>
  ): Promise<Answer<OperationOf<Paths[Path], 'post'>>> {
    return send('POST', path, input)
  }

  put<Path extends PathWith<Paths, 'put'>>(
    path: Path,
    ...[input]: Arguments<Input<OperationOf<Paths[Path], 'put'>>>
  ): Promise<Answer<OperationOf<Paths[Path], 'put'>>> {
    return send('PUT', path, input)
  }

  delete<Path extends PathWith<Paths, 'delete'>>(
    path: Path,
    ...[input]: Arguments<Input<OperationOf<Paths[Path], 'delete'>>>
  ): Promise<Answer<OperationOf<Paths[Path], 'delete'>>> {
    return send('DELETE', path, input)
  }

  /** Posts a file as it is, without encoding it as JSON. */
  postFile<Path extends PathWith<Paths, 'post'>>(
    path: Path,
    file: { text: string; contentType: string },
    input: Parameters<OperationOf<Paths[Path], 'post'>>,
  ): Promise<Answer<OperationOf<Paths[Path], 'post'>>> {
    return send('POST', path, { ...(input as AnyInput), ...file })
  }

  /** Downloads a file to the browser under the name that the daemon gives it. */
  download<Path extends PathWith<Paths, 'get'>>(
    path: Path,
    input: Parameters<OperationOf<Paths[Path], 'get'>>,
  ): Promise<void> {
    return download(resolve(path, input as AnyInput))
  }

  /** Address of a resource, for a link that the browser follows by itself. */
  address<Path extends PathWith<Paths, 'get'>>(
    path: Path,
    input: Parameters<OperationOf<Paths[Path], 'get'>>,
  ): string {
    return address(resolve(path, input as AnyInput))
  }
}

function send<T>(
  method: 'GET' | 'POST' | 'PUT' | 'DELETE',
  template: string,
  input: unknown = {},
): Promise<T> {
  const { path, query, ...options } = input as AnyInput
  return request<T>(method, resolve(template, { path, query }), options)
}

/** The path with its parameters encoded, `/` inside an id included, and with its query. */
export function resolve(template: string, { path = {}, query = {} }: AnyInput): string {
  const resolved = template.replace(/\{(\w+)\}/g, (_, name: string) => {
    const value = path[name]
    if (value === undefined) throw new Error(`${template} lacks the parameter ${name}.`)
    return encodeURIComponent(value)
  })
  const parameters = Object.entries(query)
    .filter(([, value]) => value !== undefined && value !== null && value !== '')
    .map(([name, value]) => `${name}=${encodeURIComponent(String(value))}`)
  return parameters.length === 0 ? resolved : `${resolved}?${parameters.join('&')}`
}
