#pragma once
#include <GL/glcorearb.h>

#include <functional>

namespace etalon::gl {

// Every function of OpenGL 4.5 that is called here: its name without gl, and its type.
#define ETALON_GL_FUNCTIONS(F)                                                                  \
    F(AttachShader, ATTACHSHADER)                                                               \
    F(BindBufferRange, BINDBUFFERRANGE)                                                         \
    F(BindBuffer, BINDBUFFER)                                                                   \
    F(BindFramebuffer, BINDFRAMEBUFFER)                                                         \
    F(BindImageTexture, BINDIMAGETEXTURE)                                                       \
    F(BindSampler, BINDSAMPLER)                                                                 \
    F(BindTextureUnit, BINDTEXTUREUNIT)                                                         \
    F(BindVertexArray, BINDVERTEXARRAY)                                                         \
    F(BlendFunc, BLENDFUNC)                                                                     \
    F(BlendFunci, BLENDFUNCI)                                                                   \
    F(BlitNamedFramebuffer, BLITNAMEDFRAMEBUFFER)                                               \
    F(CheckNamedFramebufferStatus, CHECKNAMEDFRAMEBUFFERSTATUS)                                 \
    F(ClearNamedBufferSubData, CLEARNAMEDBUFFERSUBDATA)                                         \
    F(ClearNamedFramebufferfv, CLEARNAMEDFRAMEBUFFERFV)                                         \
    F(ClearNamedFramebufferiv, CLEARNAMEDFRAMEBUFFERIV)                                         \
    F(ClearNamedFramebufferuiv, CLEARNAMEDFRAMEBUFFERUIV)                                       \
    F(ClientWaitSync, CLIENTWAITSYNC)                                                           \
    F(ClipControl, CLIPCONTROL)                                                                 \
    F(CompileShader, COMPILESHADER)                                                             \
    F(CopyNamedBufferSubData, COPYNAMEDBUFFERSUBDATA)                                           \
    F(CreateBuffers, CREATEBUFFERS)                                                             \
    F(CreateFramebuffers, CREATEFRAMEBUFFERS)                                                   \
    F(CreateProgram, CREATEPROGRAM)                                                             \
    F(CreateQueries, CREATEQUERIES)                                                             \
    F(CreateSamplers, CREATESAMPLERS)                                                           \
    F(CreateShader, CREATESHADER)                                                               \
    F(CreateTextures, CREATETEXTURES)                                                           \
    F(CreateVertexArrays, CREATEVERTEXARRAYS)                                                   \
    F(CullFace, CULLFACE)                                                                       \
    F(DebugMessageCallback, DEBUGMESSAGECALLBACK)                                               \
    F(DeleteBuffers, DELETEBUFFERS)                                                             \
    F(DeleteFramebuffers, DELETEFRAMEBUFFERS)                                                   \
    F(DeleteProgram, DELETEPROGRAM)                                                             \
    F(DeleteQueries, DELETEQUERIES)                                                             \
    F(DeleteSamplers, DELETESAMPLERS)                                                           \
    F(DeleteShader, DELETESHADER)                                                               \
    F(DeleteSync, DELETESYNC)                                                                   \
    F(DeleteTextures, DELETETEXTURES)                                                           \
    F(DeleteVertexArrays, DELETEVERTEXARRAYS)                                                   \
    F(DepthFunc, DEPTHFUNC)                                                                     \
    F(DepthMask, DEPTHMASK)                                                                     \
    F(Disable, DISABLE)                                                                         \
    F(Disablei, DISABLEI)                                                                       \
    F(DispatchCompute, DISPATCHCOMPUTE)                                                         \
    F(DispatchComputeIndirect, DISPATCHCOMPUTEINDIRECT)                                         \
    F(DrawArraysInstancedBaseInstance, DRAWARRAYSINSTANCEDBASEINSTANCE)                         \
    F(DrawElementsInstancedBaseVertexBaseInstance, DRAWELEMENTSINSTANCEDBASEVERTEXBASEINSTANCE) \
    F(Enable, ENABLE)                                                                           \
    F(EnableVertexArrayAttrib, ENABLEVERTEXARRAYATTRIB)                                         \
    F(Enablei, ENABLEI)                                                                         \
    F(FenceSync, FENCESYNC)                                                                     \
    F(Finish, FINISH)                                                                           \
    F(Flush, FLUSH)                                                                             \
    F(FrontFace, FRONTFACE)                                                                     \
    F(GetError, GETERROR)                                                                       \
    F(GetFloatv, GETFLOATV)                                                                     \
    F(GetInteger64v, GETINTEGER64V)                                                             \
    F(GetIntegeri_v, GETINTEGERI_V)                                                             \
    F(GetIntegerv, GETINTEGERV)                                                                 \
    F(GetInternalformativ, GETINTERNALFORMATIV)                                                 \
    F(GetMultisamplefv, GETMULTISAMPLEFV)                                                       \
    F(GetNamedBufferSubData, GETNAMEDBUFFERSUBDATA)                                             \
    F(GetProgramInfoLog, GETPROGRAMINFOLOG)                                                     \
    F(GetProgramiv, GETPROGRAMIV)                                                               \
    F(GetQueryObjectui64v, GETQUERYOBJECTUI64V)                                                 \
    F(GetShaderInfoLog, GETSHADERINFOLOG)                                                       \
    F(GetShaderiv, GETSHADERIV)                                                                 \
    F(GetString, GETSTRING)                                                                     \
    F(GetStringi, GETSTRINGI)                                                                   \
    F(GetTextureSubImage, GETTEXTURESUBIMAGE)                                                   \
    F(LineWidth, LINEWIDTH)                                                                     \
    F(LinkProgram, LINKPROGRAM)                                                                 \
    F(MemoryBarrier, MEMORYBARRIER)                                                             \
    F(NamedBufferStorage, NAMEDBUFFERSTORAGE)                                                   \
    F(NamedBufferSubData, NAMEDBUFFERSUBDATA)                                                   \
    F(NamedFramebufferDrawBuffers, NAMEDFRAMEBUFFERDRAWBUFFERS)                                 \
    F(NamedFramebufferReadBuffer, NAMEDFRAMEBUFFERREADBUFFER)                                   \
    F(NamedFramebufferTextureLayer, NAMEDFRAMEBUFFERTEXTURELAYER)                               \
    F(NamedFramebufferTexture, NAMEDFRAMEBUFFERTEXTURE)                                         \
    F(PixelStorei, PIXELSTOREI)                                                                 \
    F(PolygonMode, POLYGONMODE)                                                                 \
    F(ProvokingVertex, PROVOKINGVERTEX)                                                         \
    F(QueryCounter, QUERYCOUNTER)                                                               \
    F(SamplerParameterf, SAMPLERPARAMETERF)                                                     \
    F(SamplerParameteri, SAMPLERPARAMETERI)                                                     \
    F(Scissor, SCISSOR)                                                                         \
    F(ShaderSource, SHADERSOURCE)                                                               \
    F(TextureParameteri, TEXTUREPARAMETERI)                                                     \
    F(TextureStorage2D, TEXTURESTORAGE2D)                                                       \
    F(TextureStorage2DMultisample, TEXTURESTORAGE2DMULTISAMPLE)                                 \
    F(TextureStorage3D, TEXTURESTORAGE3D)                                                       \
    F(TextureSubImage2D, TEXTURESUBIMAGE2D)                                                     \
    F(TextureSubImage3D, TEXTURESUBIMAGE3D)                                                     \
    F(UseProgram, USEPROGRAM)                                                                   \
    F(VertexArrayAttribBinding, VERTEXARRAYATTRIBBINDING)                                       \
    F(VertexArrayAttribFormat, VERTEXARRAYATTRIBFORMAT)                                         \
    F(VertexArrayAttribIFormat, VERTEXARRAYATTRIBIFORMAT)                                       \
    F(VertexArrayBindingDivisor, VERTEXARRAYBINDINGDIVISOR)                                     \
    F(VertexArrayElementBuffer, VERTEXARRAYELEMENTBUFFER)                                       \
    F(VertexArrayVertexBuffer, VERTEXARRAYVERTEXBUFFER)                                         \
    F(Viewport, VIEWPORT)

/// The functions of one context, called while it is current: `functions.DrawArrays(...)` is glDrawArrays.
struct Functions {
#define ETALON_GL_DECLARE(name, type) PFNGL##type##PROC name = nullptr;
    ETALON_GL_FUNCTIONS(ETALON_GL_DECLARE)
#undef ETALON_GL_DECLARE
};

/// Finds each by `find` ("glDrawArrays" and so on). Throws Error(machine) naming the first that is missing.
Functions load_functions(const std::function<void*(const char*)>& find);

/// Throws Error(machine) naming `call` where OpenGL has noted an error since it was last asked.
void check(const Functions& gl, const char* call);

}  // namespace etalon::gl
